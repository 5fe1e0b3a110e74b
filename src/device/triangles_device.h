// The triangles of an engine in a device's memory. For sources that include a device.
#pragma once

#include "exec/bulk_links.h"
#include "exec/device.h"
#include "exec/executor.h"
#include "object_tree/triangle_list.h"
#include "scene/triangle_source.h"

namespace raysheaf {

using CornersOfOne = std::array<Vec3, 3>;
static_assert(sizeof(CornersOfOne) == 3 * sizeof(Vec3));

template <class Device>
class DeviceTriangles {
 public:
  explicit DeviceTriangles(Device& device) : device_(device) {}

  void set(const Executor& executor, const TriangleSource& source) {
    set(executor, source.count, source.flags,
        [&](std::size_t begin, std::size_t end, CornersOfOne* out) {
          source.for_each_part(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end),
                               [&](const TriangleRun& run, std::uint32_t from, std::uint32_t to) {
                                 for (std::uint32_t i = from; i < to; ++i) *out++ = run.corners(i);
                               });
        });
  }

  /// For triangles in another layout: `put(begin, end, out)` writes triangles [begin, end) to
  /// `out`, in several threads at once. `flags` may be null.
  template <class Put>
  void set(const Executor& executor, std::uint32_t count, const std::uint8_t* flags,
           const Put& put) {
    constexpr const char* kStage = "copy: triangles";
    corners_.resize_uninitialized(kStage, 0);
    flags_.resize_uninitialized(kStage, 0);
    corners_.resize_uninitialized(kStage, std::size_t{3} * count);
    if (flags != nullptr) {
      flags_.resize_uninitialized(kStage, count);
      device_.copy(kStage, flags_.data(), flags, count);
    }
    auto* const to = reinterpret_cast<CornersOfOne*>(corners_.data());
    uplink_.send(kStage, executor, View<CornersOfOne>(to, count), put);
  }

  /// To be written by the device.
  [[nodiscard]] View<Vec3> corners() { return corners_.view(); }
  [[nodiscard]] View<std::uint8_t> flags() { return flags_.view(); }

  [[nodiscard]] TriangleList list() const { return {corners_.view_const(), flags_.view_const()}; }
  [[nodiscard]] std::size_t memory_bytes() const {
    return corners_.capacity_bytes() + flags_.capacity_bytes();
  }

 private:
  Device& device_;
  BulkUplink<Device> uplink_{device_};
  DeviceBuffer<Vec3> corners_{device_.allocator()};
  DeviceBuffer<std::uint8_t> flags_{device_.allocator()};
};

/// A scene's triangles for a tracer: in place if they are in the device's memory, otherwise copied.
template <class Device>
class GivenTriangles {
 public:
  explicit GivenTriangles(Device& device) : device_(device) {}

  void set(const TriangleList& given) {
    list_ = {};
    const TriangleList list{there(given.corners, &corners_), there(given.flags, &flags_)};
    list_ = list;
  }
  [[nodiscard]] const TriangleList& list() const { return list_; }

 private:
  template <class T>
  View<const T> there(View<const T> given, DeviceBuffer<T>* room) {
    if (given.empty() || device_.is_device_memory(given.data, "triangles")) return given;
    upload(device_, "copy: triangles", given, room);
    return room->view_const();
  }

  Device& device_;
  DeviceBuffer<Vec3> corners_{device_.allocator()};
  DeviceBuffer<std::uint8_t> flags_{device_.allocator()};
  TriangleList list_;
};

}  // namespace raysheaf
