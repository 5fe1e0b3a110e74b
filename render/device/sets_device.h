// Sets of fragments in a device's memory, derived from other sets. For sources that include a
// device.
#pragma once

#include <memory>

#include "render/device/scene_device.h"

namespace raysheaf {

template <class Device>
class DeviceSets {
 public:
  using Made = std::unique_ptr<DeviceSet>;

  explicit DeviceSets(Device& device) : device_(device) {}

  /// A set of this many uninitialized fragments.
  [[nodiscard]] Made make(const char* stage, std::size_t count) {
    auto set = std::make_unique<DeviceSet>(device_.allocator());
    set->fragments.resize_uninitialized(stage, count);
    set->count = count;
    return set;
  }

  /// A copy of the fragments [begin, end) of a set.
  [[nodiscard]] Made part(const char* stage, const DeviceSet& set, std::size_t begin,
                          std::size_t end) {
    Made some = make(stage, end - begin);
    device_.copy(stage, some->fragments.data(), set.fragments.data() + begin,
                 some->count * sizeof(Fragment));
    return some;
  }

  /// The union of both, with the first set's fragments before the second's in each pixel;
  /// `pixel_bits` is the width of a pixel's number.
  [[nodiscard]] Made merged(const DeviceSet& a, const DeviceSet& b, std::uint32_t pixel_bits) {
    const View<const Fragment> first = a.view(), second = b.view();
    const std::size_t count = first.size + second.size;
    check_item_count("order: fragments", count);
    columns_.resize_uninitialized("order: fragments", count, true);
    pixels_of_both_on(device_, first, second, columns_.keys.data(), columns_.values.data());
    device_.sort_pairs("order: fragments", &columns_, {0, pixel_bits});
    Made all = make("order: fragments", count);
    merge_on(device_, first, second, columns_.values.data(), all->fragments.data());
    return all;
  }

 private:
  Device& device_;
  SortColumns<std::uint32_t> columns_{device_.allocator()};
};

}  // namespace raysheaf
