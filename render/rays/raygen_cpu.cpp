#include <algorithm>
#include <bit>
#include <limits>

#include "base/bits.h"
#include "exec/scan.h"
#include "raysheaf/error.h"
#include "render/rays/hash_body.h"
#include "render/rays/mirror_rays.h"
#include "render/rays/raygen.h"
#include "render/rays/scatter_body.h"
#include "render/rays/shadow_body.h"
#include "render/rays/sky_body.h"

namespace raysheaf {
namespace {

/// Removes the slots for which `has_ray(slot)` is false, and makes room for the others' rays, and
/// for keys if requested.
template <class HasRay>
void take_slots(const Executor& executor, std::size_t slot_count, Keys keys, const HasRay& has_ray,
                RayBatch* batch) {
  LargeVector<std::uint8_t> empty(slot_count);
  executor.for_each_block(slot_count, kWorkGrain, [&](std::size_t begin, std::size_t end) {
    const HasRay has_one = has_ray;  // a local copy, which cannot alias the written bytes
    std::uint8_t* const out = empty.data();
    for (std::size_t slot = begin; slot < end; ++slot) out[slot] = has_one(slot) ? 0 : 1;
  });
  batch->slots = trim(executor, empty);
  const std::size_t count = batch->slots.size();
  batch->rays.resize(count);
  if (batch->kind != RayKind::kShadow) batch->weights.resize(count);
  const bool keyed = keys == Keys::kMade;
  if (keyed) {
    batch->keys.resize(count);
    batch->pixels.resize(count);
  }
  if (keyed && batch->kind == RayKind::kShadow) {
    batch->lights.resize(count);
    batch->places.resize(count);
  }
}

/// Ray i of a batch of reflections or refractions.
void make_bounce_ray(View<const Fragment> fragments, std::size_t i, RayBatch* batch) {
  const Fragment& f = fragments[batch->slots[i]];
  const Bounce b = bounce(f, batch->kind);
  batch->weights[i] = f.weight * b.part;
  batch->rays[i] = {offset_point(f.surface, b.direction, 0), 0, b.direction,
                    std::numeric_limits<float>::infinity()};
}

/// Rays [begin, end) of a batch of reflections.
void make_reflections(View<const Fragment> fragments, std::size_t begin, std::size_t end,
                      RayBatch* batch) {
  std::uint16_t odd[kLightGroups];
  make_mirror_rays(fragments, View<const std::uint32_t>(batch->slots).slice(begin, end - begin),
                   &batch->rays[begin], &batch->weights[begin], odd);
  for (std::size_t group = 0; group * kLightLanes < end - begin; ++group) {
    for (std::uint32_t rest = odd[group]; rest != 0; rest &= rest - 1)
      make_bounce_ray(
          fragments, begin + group * kLightLanes + static_cast<std::size_t>(std::countr_zero(rest)),
          batch);
  }
}

}  // namespace

std::string stage_name(RayKind kind, std::uint32_t bounce) {
  return std::string(to_string(kind)) + " rays, bounce " + std::to_string(bounce);
}

LargeVector<std::uint32_t> trim(const Executor& executor, View<const std::uint8_t> empty) {
  if (empty.size > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::kInvalidArgument, "more than 2^32 - 1 items", "trim");
  const auto is_empty = [flags = empty.data](std::size_t slot) { return flags[slot] != 0; };
  const FlagCounts counts = count_flags(executor, empty.size, is_empty);
  LargeVector<std::uint32_t> slots(empty.size - counts.total);
  for_each_scanned(executor, counts, empty.size, is_empty,
                   [out = slots.data()](std::size_t i, bool gap, std::uint32_t empty_up_to) {
                     const auto slot = static_cast<std::uint32_t>(i);
                     if (!gap) out[slot - empty_up_to] = slot;
                   });
  return slots;
}

RayBatch make_sky_rays(const Executor& executor, View<const Fragment> fragments,
                       const EnvironmentView& sky, const Box& scene_bounds, SampleOf sample,
                       Keys keys) {
  RayBatch batch;
  batch.kind = RayKind::kShadow;
  const LightReach reach = light_reach(scene_bounds);
  const ShadowKeyLayout layout = shadow_key_layout(kSkyStrategies);
  batch.key_bits = layout.key_bits();
  const std::size_t slot_count = fragments.size * kSkyStrategies;
  LargeVector<Ray> chosen(slot_count);  // for the slots that have a ray
  const auto has_ray = [&](std::size_t slot) {
    const Fragment& f = fragments[slot % fragments.size];
    if (!takes_light(f)) return false;
    const auto strategy = static_cast<std::uint32_t>(slot / fragments.size);
    const LightSample seen = choose_in_sky(f, sky, strategy, sample);
    if (!faces_light(f, seen)) return false;
    chosen[slot] = shadow_ray(f, seen, reach);
    return true;
  };
  take_slots(executor, slot_count, keys, has_ray, &batch);
  executor.for_each(batch.slots.size(), kWorkGrain, [&](std::size_t i) {
    const std::size_t slot = batch.slots[i];
    const Ray ray = batch.rays[i] = chosen[slot];
    if (keys == Keys::kNone) return;
    batch.pixels[i] = fragments[slot % fragments.size].pixel;
    batch.lights[i] = static_cast<std::uint32_t>(slot / fragments.size);
    batch.places[i] = octahedral(ray.direction);
    batch.keys[i] = shadow_key(layout, batch.lights[i], batch.places[i]);
  });
  return batch;
}

RayBatch make_bounce_rays(const Executor& executor, View<const Fragment> fragments, RayKind kind,
                          const Box& scene_bounds, Keys keys, View<const std::uint8_t> going_on) {
  RayBatch batch;
  batch.kind = kind;
  batch.key_bits = kBounceKeyBits;
  const std::uint8_t bit = bit_of(kind);
  const auto has_ray = [going_on, bit, fragments](std::size_t slot) {
    if (!going_on.empty()) return (going_on[slot] & bit) != 0;
    const Fragment& f = fragments[slot];
    return f.triangle != kInvalidId && (rays_of(f, scattered_parts(f)) & bit) != 0;
  };
  take_slots(executor, fragments.size, keys, has_ray, &batch);
  const std::size_t count = batch.slots.size();
  executor.for_each(div_ceil(count, kLightBlock), 4, [&](std::size_t block) {
    const std::size_t begin = block * kLightBlock, end = std::min(count, begin + kLightBlock);
    if (kind == RayKind::kReflection) return make_reflections(fragments, begin, end, &batch);
    for (std::size_t i = begin; i < end; ++i) make_bounce_ray(fragments, i, &batch);
  });
  if (keys == Keys::kNone) return batch;
  executor.for_each(count, kWorkGrain, [&](std::size_t i) {
    batch.pixels[i] = fragments[batch.slots[i]].pixel;
    batch.keys[i] = bounce_key(scene_bounds, batch.rays[i].origin, batch.rays[i].direction);
  });
  return batch;
}

}  // namespace raysheaf
