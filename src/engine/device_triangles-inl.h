// The triangles of an engine in a device's memory; for the sources that know which device it is.
#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include "exec/device.h"
#include "exec/executor.h"
#include "object/triangle_list.h"
#include "object/triangle_source.h"

namespace raysheaf {

template <class Device>
class DeviceTriangles {
 public:
  explicit DeviceTriangles(Device& device) : device_(device) {}

  void set(const Executor& executor, const TriangleSource& source) {
    set(executor, source.count, source.flags,
        [&](std::uint32_t begin, std::uint32_t end, Vec3* all) {
          source.for_each_part(
              begin, end, [&](const TriangleRun& run, std::uint32_t from, std::uint32_t to) {
                for (std::uint32_t i = from; i < to; ++i) {
                  const std::array<Vec3, 3> corners = run.corners(i);
                  std::copy(corners.begin(), corners.end(), all + std::size_t{3} * (run.first + i));
                }
              });
        });
  }

  /// Of triangles that lie otherwise: `put(begin, end, all)` writes the corners of those numbers to
  /// their places among `all`, for several threads at once. `flags` may be null.
  template <class Put>
  void set(const Executor& executor, std::uint32_t count, const std::uint8_t* flags,
           const Put& put) {
    constexpr const char* kStage = "copy: triangles";
    const std::size_t bytes = std::size_t{3} * count * sizeof(Vec3);
    corners_.resize_uninitialized(kStage, 0);
    flags_.resize_uninitialized(kStage, 0);
    if (std::exchange(was_sent_, false)) uplink_.done_with(kStage);
    Vec3* const room = reinterpret_cast<Vec3*>(uplink_.room(kStage, bytes));
    executor.for_each_block(count, 4096, [&](std::size_t begin, std::size_t end) {
      put(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), room);
    });
    corners_.resize_uninitialized(kStage, std::size_t{3} * count);
    if (flags != nullptr) {
      flags_.resize_uninitialized(kStage, count);
      device_.copy(kStage, flags_.data(), flags, count);
    }
    device_.synchronize(kStage);  // there is memory for what is sent
    uplink_.send(kStage, corners_.data(), bytes);
    uplink_.see(kStage);
    was_sent_ = true;
  }

  [[nodiscard]] TriangleList list() const { return {corners_.view_const(), flags_.view_const()}; }
  [[nodiscard]] std::size_t memory_bytes() const {
    return corners_.capacity_bytes() + flags_.capacity_bytes();
  }

 private:
  Device& device_;
  typename Device::Uplink uplink_{device_};  ///< of corners
  bool was_sent_ = false;
  DeviceBuffer<Vec3> corners_{device_.allocator()};
  DeviceBuffer<std::uint8_t> flags_{device_.allocator()};
};

}  // namespace raysheaf
