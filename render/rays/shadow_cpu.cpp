// make_shadow_rays(): finds which fragments face which lights, scans the results, and makes the
// rays.
#include <algorithm>
#include <bit>

#include "base/bits.h"
#include "base/buffer.h"
#include "exec/scan.h"
#include "render/rays/hash_body.h"
#include "render/rays/offset_body.h"
#include "render/rays/point_light.h"
#include "render/rays/raygen.h"
#include "render/rays/shadow_body.h"

namespace raysheaf {
namespace {

/// The rays of a batch, light by light, and for each light in the order of the fragments:
///
///             block 0   block 1   ...          16 fragments a word of `facing_`
///   light 0  | 1101.. | 0110.. |
///   light 1  | 0001.. | 1111.. |     counts -> scan -> where the rays of (light, block) begin
///
/// Rays of point lights are computed twice, because storing them temporarily is slower. Rays to a
/// chosen point on a light are stored in `chosen_` until their places are known.
class ShadowRays {
 public:
  ShadowRays(const Executor& executor, View<const Fragment> fragments,
             View<const PlacedLight> lights, std::uint32_t first_light, const Box& scene_bounds,
             SampleOf sample, Keys keys)
      : executor_(executor),
        fragments_(fragments),
        lights_(lights),
        first_light_(first_light),
        reach_(light_reach(scene_bounds)),
        sample_(sample),
        keyed_(keys == Keys::kMade),
        blocks_(div_ceil(fragments.size, kLightBlock)),
        begin_(lights.size * blocks_) {
    facing_.resize_uninitialized(begin_.size() * kLightGroups);
    columns_.resize(blocks_);
    std::size_t chosen = 0;
    for (const PlacedLight& light : lights) {
      chosen_from_.push_back(chosen);
      chosen += shines_from_point(light, sample) ? 0 : fragments.size;
    }
    chosen_.resize(chosen);
  }

  void make(const ShadowKeyLayout& layout, RayBatch* batch) {
    executor_.for_each(blocks_, kBlockGrain, [&](std::size_t block) { look(block); });
    const std::uint32_t count = exclusive_scan(executor_, begin_, begin_);
    for (std::size_t light = 1; light < lights_.size; ++light)
      batch->light_ends.push_back(begin_[light * blocks_]);
    batch->light_ends.push_back(count);
    batch->slots.resize(count);
    batch->rays.resize(count);
    if (keyed_) {
      batch->keys.resize(count);
      batch->pixels.resize(count);
      batch->lights.resize(count);
      batch->places.resize(count);
    }
    executor_.for_each(blocks_, kBlockGrain,
                       [&](std::size_t block) { fill(block, layout, batch); });
  }

 private:
  static constexpr std::size_t kBlockGrain = 4;

  [[nodiscard]] View<const Fragment> block_of(std::size_t block) const {
    const std::size_t first = block * kLightBlock;
    return fragments_.slice(first, std::min(kLightBlock, fragments_.size - first));
  }
  [[nodiscard]] std::uint16_t* facing(std::size_t light, std::size_t block) const {
    return facing_.data() + (light * blocks_ + block) * kLightGroups;
  }
  [[nodiscard]] LightSample choose(const Fragment& f, std::size_t light) const {
    return choose_on_light(f, lights_[light], first_light_ + static_cast<std::uint32_t>(light),
                           sample_);
  }

  /// Finds which fragments of a block face which lights.
  void look(std::size_t block) {
    const View<const Fragment> fragments = block_of(block);
    ShadowColumns& columns = columns_[block];
    gather_shadow_columns(fragments, &columns);
    for (std::size_t l = 0; l < lights_.size; ++l) {
      const PlacedLight& light = lights_[l];
      begin_[l * blocks_ + block] = shines_from_point(light, sample_)
                                        ? find_facing(columns, light, fragments, facing(l, block))
                                        : find_one_by_one(l, block, facing(l, block));
    }
  }

  std::uint32_t find_one_by_one(std::size_t light, std::size_t block, std::uint16_t* facing) {
    const ShadowColumns& columns = columns_[block];
    const View<const Fragment> fragments = block_of(block);
    const bool sized = has_size(lights_[light]);
    Ray* const chosen = chosen_.data() + chosen_from_[light] + block * kLightBlock;
    std::uint32_t count = 0;
    for (std::size_t group = 0; group * kLightLanes < fragments.size; ++group) {
      std::uint32_t faces = 0;
      for (std::uint32_t rest = columns.lit[group]; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
        const std::size_t i = group * kLightLanes + lane;
        const Fragment& f = fragments[i];
        if (sized && turned_away(f.surface, lights_[light])) continue;
        const LightSample seen = choose(f, light);
        if (!faces_light(f, seen)) continue;
        faces |= 1u << lane;
        chosen[i] = shadow_ray(f, seen, reach_);
      }
      facing[group] = static_cast<std::uint16_t>(faces);
      count += static_cast<std::uint32_t>(std::popcount(faces));
    }
    return count;
  }

  void fill(std::size_t block, const ShadowKeyLayout& layout, RayBatch* batch) const {
    const View<const Fragment> fragments = block_of(block);
    const ShadowColumns& columns = columns_[block];
    for (std::size_t l = 0; l < lights_.size; ++l) {
      const std::size_t begin = begin_[l * blocks_ + block];
      const std::size_t end = fill_slots(l, block, begin, batch);
      if (begin == end) continue;
      Ray* const rays = batch->rays.data() + begin;
      if (shines_from_point(lights_[l], sample_)) {
        make_point_rays(columns, lights_[l], fragments, facing(l, block), rays);
      } else {
        for (std::size_t i = begin; i < end; ++i)
          batch->rays[i] = chosen_[chosen_from_[l] + batch->slots[i] % fragments_.size];
      }
      if (keyed_) fill_keys(l, begin, end, layout, batch);
    }
  }

  std::size_t fill_slots(std::size_t light, std::size_t block, std::size_t at,
                         RayBatch* batch) const {
    const std::size_t first = light * fragments_.size + block * kLightBlock;
    const std::size_t groups = div_ceil(block_of(block).size, kLightLanes);
    for (std::size_t group = 0; group < groups; ++group) {
      for (std::uint32_t rest = facing(light, block)[group]; rest != 0; rest &= rest - 1)
        batch->slots[at++] = static_cast<std::uint32_t>(
            first + group * kLightLanes + static_cast<std::size_t>(std::countr_zero(rest)));
    }
    return at;
  }

  void fill_keys(std::size_t light, std::size_t begin, std::size_t end,
                 const ShadowKeyLayout& layout, RayBatch* batch) const {
    const std::uint32_t index = first_light_ + static_cast<std::uint32_t>(light);
    for (std::size_t i = begin; i < end; ++i) {
      batch->lights[i] = index;
      batch->places[i] = shadow_place(lights_[light], batch->rays[i], reach_);
      batch->keys[i] = shadow_key(layout, index, batch->places[i]);
      batch->pixels[i] = fragments_[batch->slots[i] % fragments_.size].pixel;
    }
  }

  const Executor& executor_;
  const View<const Fragment> fragments_;
  const View<const PlacedLight> lights_;
  const std::uint32_t first_light_;
  const LightReach reach_;
  const SampleOf sample_;
  const bool keyed_;
  const std::size_t blocks_;
  std::vector<std::uint32_t> begin_;  ///< of (light, block): counts, then places
  Buffer<std::uint16_t> facing_;
  LargeVector<ShadowColumns> columns_;    ///< of each block
  LargeVector<Ray> chosen_;               ///< of (light, fragment), for lights that are not points
  std::vector<std::size_t> chosen_from_;  ///< of each light
};

}  // namespace

RayBatch make_shadow_rays(const Executor& executor, View<const Fragment> fragments,
                          View<const PlacedLight> lights, std::uint32_t first_light,
                          std::uint32_t light_count, const Box& scene_bounds, SampleOf sample,
                          Keys keys) {
  RayBatch batch;
  batch.kind = RayKind::kShadow;
  const ShadowKeyLayout layout = shadow_key_layout(static_cast<std::uint32_t>(lights.size));
  batch.key_bits = layout.key_bits();
  batch.light_ends.reserve(light_count);
  if (light_count == 0 || fragments.empty()) {
    batch.light_ends.assign(light_count, 0);
    return batch;
  }
  ShadowRays(executor, fragments, lights.slice(first_light, light_count), first_light, scene_bounds,
             sample, keys)
      .make(layout, &batch);
  return batch;
}

}  // namespace raysheaf
