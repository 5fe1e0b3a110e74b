// Hits of a frame's rays on a device, past the holes of materials, as in render/frame/cutouts.h:
// rays whose hits lie in holes continue from behind them, in smaller batches. For the sources that
// create a device's stages.
#pragma once

#include "render/device/batches_device.h"
#include "render/device/cutout_loops_device.h"

namespace raysheaf {

/// Data that all batches of a frame share.
struct FrameOnDevice {
  StagedSceneView scene;
  bool has_holes = false, blends = false;  ///< `blends`: several samples per pixel
  View<std::uint64_t> pixel_tests;         ///< empty if no tests are counted
};

/// The query of a batch, and the pixels of its rays, in the format of `add_tests_on`.
struct BatchOnDevice {
  Facing facing = Facing::kBoth;
  std::uint32_t key_bits = 32;
  View<const Fragment> fragments;
  View<const std::uint32_t> slots;
};

template <class Device>
class DeviceCutouts {
 public:
  /// Both must outlive this object.
  DeviceCutouts(Device& device, DeviceBatches<Device>& batches)
      : device_(device), batches_(batches) {}

  void begin(const FrameOnDevice& frame) { frame_ = frame; }
  [[nodiscard]] bool any() const { return frame_.has_holes; }

  /// The first hit of each of the batch's rays that is not in a hole, valid until the next call;
  /// adds the tests to the pixels. Restores the rays afterwards.
  const IndexedHit* closest(const BatchOnDevice& batch, BatchStatistics* statistics) {
    const IndexedHit* const hits = traced(batch, batch.slots, statistics);
    return any() ? pass(batch, hits, statistics) : hits;
  }

  /// 1 for each of the batch's rays that anything stops, else 0; valid until the next call. A ray
  /// that was stopped by a triangle with holes is traced again for its closest hit, because only
  /// the triangle tells whether the hit is in a hole.
  const std::uint8_t* occluded(const BatchOnDevice& batch, BatchStatistics* statistics) {
    std::uint8_t* const occluded = batches_.occluded(batch.key_bits, statistics);
    add_tests(batch, batch.slots);
    if (!any()) return occluded;
    const View<const std::uint8_t> flags(occluded, batch.slots.size);
    const View<const std::uint32_t> stopped = flagged(flags, &chosen_);
    if (stopped.empty()) return occluded;
    keep(stopped);
    stopped_slots_.resize_uninitialized(kStage, stopped.size);
    gather(device_, kStage, batch.slots, stopped, stopped_slots_.view());
    BatchOnDevice again = batch;
    again.slots = stopped_slots_.view_const();
    const View<const IndexedHit> hits(closest(again, statistics), stopped.size);
    place_occluded_on(device_, hits, stopped.data, occluded);
    return occluded;
  }

  /// The batch's rays are those of the pixels: a pixel whose triangle has a hole at the hit gets
  /// the triangle behind it instead. `statistics()`: of the rays, if there are any.
  template <class Statistics>
  void see_through(Facing facing, std::uint32_t key_bits, std::uint32_t* triangles,
                   const Statistics& statistics) {
    const View<const Ray> rays = batches_.all_rays();
    flags_.resize_uninitialized(kStage, rays.size);
    flag_cut_away_on(device_, frame_.scene, frame_.blends, rays, triangles, flags_.data());
    const View<const std::uint32_t> away = flagged(flags_.view_const(), &chosen_);
    if (away.empty()) return;
    keep(away);
    const View<const IndexedHit> hits(closest({facing, key_bits, {}, away}, statistics()),
                                      away.size);
    place_triangles_on(device_, hits, away.data, triangles);
  }

 private:
  static constexpr const char* kStage = "trace: holes";

  const IndexedHit* traced(const BatchOnDevice& batch, View<const std::uint32_t> slots,
                           BatchStatistics* statistics) {
    const IndexedHit* const hits = batches_.closest(batch.facing, batch.key_bits, statistics);
    add_tests(batch, slots);
    return hits;
  }

  /// Adds the tests of the rays that were traced last.
  void add_tests(const BatchOnDevice& batch, View<const std::uint32_t> slots) {
    if (frame_.pixel_tests.empty()) return;
    add_tests_on(device_, batch.fragments, slots, batches_.tests(), frame_.pixel_tests);
  }

  /// The slots of the rays at these places in the batch.
  View<const std::uint32_t> slots_at(const BatchOnDevice& batch, View<const std::uint32_t> places) {
    if (batch.slots.empty() || frame_.pixel_tests.empty()) return places;
    slots_.resize_uninitialized(kStage, places.size);
    gather(device_, kStage, batch.slots, places, slots_.view());
    return slots_.view_const();
  }

  /// Replaces `hits` of the batch's rays that lie in holes by the next hits behind them.
  const IndexedHit* pass(const BatchOnDevice& batch, const IndexedHit* hits,
                         BatchStatistics* statistics) {
    const std::size_t rays = batches_.all_rays().size;
    all_.resize_uninitialized(kStage, rays);
    places_.resize_uninitialized(kStage, rays);
    device_.copy(kStage, all_.data(), hits, rays * sizeof(IndexedHit));
    number(device_, kStage, places_.view());
    bool goes_on = false;
    while (true) {
      const RaysOnWay on_way{batches_.all_rays(), hits, places_.data()};
      flags_.resize_uninitialized(kStage, on_way.rays.size);
      pass_holes_on(device_, frame_.scene, frame_.blends, on_way, all_.data(), flags_.data());
      const View<const std::uint32_t> kept = flagged(flags_.view_const(), &kept_);
      if (kept.empty()) break;
      spare_rays_.resize_uninitialized(kStage, kept.size);
      spare_places_.resize_uninitialized(kStage, kept.size);
      rays_behind_on(device_, on_way, kept, spare_rays_.data(), spare_places_.data());
      keep_keys(kept);
      places_.swap(spare_places_);
      batches_.swap(&spare_rays_, &spare_keys_);
      if (!goes_on) {
        first_rays_.swap(spare_rays_);
        first_keys_.swap(spare_keys_);
        goes_on = true;
      }
      hits = traced(batch, slots_at(batch, places_.view_const()), statistics);
      place_hits_on(device_, View<const IndexedHit>(hits, kept.size), places_.data(), all_.data());
    }
    if (goes_on) batches_.swap(&first_rays_, &first_keys_);
    return all_.data();
  }

  /// Reduces the batch to the rays that `places` names.
  void keep(View<const std::uint32_t> places) {
    spare_rays_.resize_uninitialized(kStage, places.size);
    gather(device_, kStage, batches_.all_rays(), places, spare_rays_.view());
    keep_keys(places);
    batches_.swap(&spare_rays_, &spare_keys_);
  }

  View<const std::uint32_t> flagged(View<const std::uint8_t> flags,
                                    DeviceBuffer<std::uint32_t>* out) {
    out->resize_uninitialized(kStage, flags.size);
    return out->view_const().slice(0, device_.select(kStage, flags, out->view()));
  }
  void keep_keys(View<const std::uint32_t> places) {
    const View<const std::uint32_t> keys = batches_.all_keys();
    spare_keys_.resize_uninitialized(kStage, keys.empty() ? 0 : places.size);
    if (!keys.empty()) gather(device_, kStage, keys, places, spare_keys_.view());
  }

  Device& device_;
  DeviceBatches<Device>& batches_;
  DeviceAllocator& memory_ = device_.allocator();
  FrameOnDevice frame_;
  DeviceBuffer<IndexedHit> all_{memory_};
  DeviceBuffer<std::uint8_t> flags_{memory_};
  DeviceBuffer<std::uint32_t> chosen_{memory_}, kept_{memory_};
  DeviceBuffer<std::uint32_t> slots_{memory_}, stopped_slots_{memory_};
  DeviceBuffer<std::uint32_t> places_{memory_}, spare_places_{memory_};
  DeviceBuffer<Ray> spare_rays_{memory_}, first_rays_{memory_};
  DeviceBuffer<std::uint32_t> spare_keys_{memory_}, first_keys_{memory_};
};

}  // namespace raysheaf
