// The rays of a batch that stay on a device, in the order of a curve, under a tree of shafts.
#pragma once

#include <vector>

#include "out_of_core/block_queries_device.h"

namespace raysheaf {

/// The rays, and the tree over them.
template <class Device>
class DeviceRays {
 public:
  explicit DeviceRays(Device& device)
      : device_(device),
        rays_(device.allocator()),
        spare_rays_(device.allocator()),
        numbers_(device.allocator()),
        spare_numbers_(device.allocator()),
        left_(device.allocator()),
        kept_(device.allocator()) {}

  /// Copies and orders the rays. `scene` contains everything that they may hit. Has no tree until
  /// `build`.
  void take(View<const Ray> rays, const Box& scene) {
    scene_ = scene;
    DeviceBuffer<Ray> given(device_.allocator());
    SortColumns<std::uint64_t> columns(device_.allocator());
    upload(device_, "rays: keys", rays, &given);
    columns.resize_uninitialized("rays: keys", rays.size, true);
    key_rays_on(device_, given.view_const(), scene, columns.keys.data(), columns.values.data());
    device_.sort_pairs("rays: sort", &columns, {0, kRayKeyBits});
    rays_.resize_uninitialized("rays: sort", rays.size);
    gather(device_, "rays: sort", given.view_const(), columns.values.view_const(), rays_.view());
    numbers_.swap(columns.values);
    state_ = {rays_.view(), numbers_.data(), {}};
  }

  /// Removes rays that are done; removes the tree until `build`. Waits.
  void drop_done() {
    left_.resize_uninitialized("rays: left", rays_.size());
    kept_.resize_uninitialized("rays: left", rays_.size());
    flag_left_on(device_, numbers_.view_const(), left_.data());
    const std::uint32_t count = device_.select("rays: left", left_.view_const(), kept_.view());
    const View<const std::uint32_t> kept = kept_.view_const().slice(0, count);
    spare_rays_.resize_uninitialized("rays: left", count);
    spare_numbers_.resize_uninitialized("rays: left", count);
    gather(device_, "rays: left", rays_.view_const(), kept, spare_rays_.view());
    gather(device_, "rays: left", numbers_.view_const(), kept, spare_numbers_.view());
    rays_.swap(spare_rays_);
    numbers_.swap(spare_numbers_);
    state_ = {rays_.view(), numbers_.data(), {}};
  }

  /// Builds the tree over the current rays.
  void build() {
    state_.levels = {};
    std::size_t count = rays_.size();
    while (count > kRayBranching || state_.levels.count == 0) {
      count = nodes_above(count);
      add_level(state_.levels.count++, count);
    }
  }

  [[nodiscard]] std::size_t size() const { return rays_.size(); }
  [[nodiscard]] const RayState& state() const { return state_; }
  [[nodiscard]] View<const Shaft> leaves() const { return shafts_[0].view_const(); }

 private:
  void add_level(std::uint32_t level, std::size_t count) {
    if (shafts_.size() <= level) {
      shafts_.emplace_back(device_.allocator());
      tests_.emplace_back(device_.allocator());
    }
    shafts_[level].resize_uninitialized("rays: levels", count);
    tests_[level].resize_uninitialized("rays: levels", count);
    const View<Shaft> shafts = shafts_[level].view();
    if (level == 0) {
      bound_stream_leaves_on(device_, rays_.view_const(), scene_, shafts, tests_[0].data());
    } else {
      bound_stream_level_on(device_, shafts_[level - 1].view_const(), shafts, tests_[level].data());
    }
    state_.levels.level[level] = tests_[level].data();
    state_.levels.size[level] = static_cast<std::uint32_t>(count);
  }

  Device& device_;
  Box scene_;
  DeviceBuffer<Ray> rays_, spare_rays_;
  DeviceBuffer<std::uint32_t> numbers_, spare_numbers_;
  DeviceBuffer<std::uint8_t> left_;
  DeviceBuffer<std::uint32_t> kept_;
  std::vector<DeviceBuffer<Shaft>> shafts_;  // one for each level
  std::vector<DeviceBuffer<BeamTest>> tests_;
  RayState state_;
};

}  // namespace raysheaf
