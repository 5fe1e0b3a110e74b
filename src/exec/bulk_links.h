// Copies large arrays between the host and a device in parts: while one part is copied, all threads
// write or read the next, in host memory that the device accesses directly. Include the device's
// links (exec/links.h), too.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "base/view.h"
#include "exec/executor.h"

namespace raysheaf {

/// The most host memory that a link allocates.
inline constexpr std::size_t kPartBytes = std::size_t{4} << 20;
/// Smaller arrays are as fast by the device's own copy.
inline constexpr std::size_t kFewBulkBytes = std::size_t{1} << 20;

template <class T>
constexpr std::size_t items_of_part(std::size_t part_bytes) {
  return std::max<std::size_t>(1, part_bytes / sizeof(T));
}

template <class Device>
class BulkUplink {
 public:
  explicit BulkUplink(Device& device, std::size_t part_bytes = kPartBytes)
      : device_(device), part_bytes_(part_bytes) {}

  /// `put(begin, end, out)` writes items [begin, end) to `out`. The device's work that is queued
  /// from now on sees the items.
  template <class T, class Put>
  void send(const char* stage, const Executor& executor, View<T> to, const Put& put) {
    device_.synchronize(stage);  // ensures that the destination is allocated
    const std::size_t part = items_of_part<T>(part_bytes_);
    for (std::size_t first = 0; first < to.size; first += part) {
      Lane& lane = lanes_[turn_ ^= 1];
      const std::size_t count = std::min(part, to.size - first);
      if (std::exchange(lane.was_sent, false)) lane.link.done_with(stage);
      T* const room = reinterpret_cast<T*>(lane.link.room(stage, count * sizeof(T)));
      executor.for_each_block(count, kCopyGrain, [&](std::size_t begin, std::size_t end) {
        put(first + begin, first + end, room + begin);
      });
      lane.link.send(stage, to.data + first, count * sizeof(T));
      lane.link.see(stage);
      lane.was_sent = true;
    }
  }

  /// Copies contiguous items. Small arrays, and all without an executor, use the device's own copy.
  template <class T>
  void copy(const char* stage, const Executor* executor, View<const T> from, View<T> to) {
    if (executor == nullptr || from.size * sizeof(T) < kFewBulkBytes)
      return device_.copy(stage, to.data, from.data, from.size * sizeof(T));
    send(stage, *executor, to, [from](std::size_t begin, std::size_t end, T* out) {
      std::copy(from.begin() + begin, from.begin() + end, out);
    });
  }

 private:
  struct Lane {
    typename Device::Uplink link;
    bool was_sent = false;
    explicit Lane(Device& device) : link(device) {}
  };
  Device& device_;
  const std::size_t part_bytes_;
  std::array<Lane, 2> lanes_{Lane(device_), Lane(device_)};
  std::size_t turn_ = 0;
};

template <class Device>
class BulkDownlink {
 public:
  explicit BulkDownlink(Device& device, std::size_t part_bytes = kPartBytes)
      : device_(device), part_bytes_(part_bytes), links_{Link(device), Link(device)} {}

  /// Fetches the values that `from` has when the device's queue reaches this point.
  template <class T>
  void fetch(const char* stage, const Executor& executor, const T* from, View<T> to) {
    const std::size_t part = items_of_part<T>(part_bytes_);
    const auto count = [&](std::size_t first) { return std::min(part, to.size - first); };
    std::size_t turn = 0;
    if (!to.empty()) links_[turn].ask(stage, from, count(0) * sizeof(T));
    for (std::size_t first = 0; first < to.size; first += part, turn ^= 1) {
      const std::size_t next = first + part;
      if (next < to.size) links_[turn ^ 1].ask(stage, from + next, count(next) * sizeof(T));
      const T* const room = reinterpret_cast<const T*>(links_[turn].wait(stage));
      executor.for_each_block(count(first), kCopyGrain, [&](std::size_t begin, std::size_t end) {
        std::copy(room + begin, room + end, to.data + first + begin);
      });
    }
  }

  /// As `copy` of the uplink.
  template <class T>
  void copy(const char* stage, const Executor* executor, const T* from, View<T> to) {
    if (executor == nullptr || to.size * sizeof(T) < kFewBulkBytes)
      return device_.copy(stage, to.data, from, to.size * sizeof(T));
    fetch(stage, *executor, from, to);
  }

 private:
  using Link = typename Device::Downlink;
  Device& device_;
  const std::size_t part_bytes_;
  std::array<Link, 2> links_;
};

}  // namespace raysheaf
