#include <hwy/cache_control.h>

#include <cstddef>

#include "order/order.h"
#include "raygen/hash_body.h"
#include "raygen/raygen.h"
#include "raygen/scatter_body.h"
#include "raygen/shadow_body.h"
#include "raygen/sky_body.h"

namespace raysheaf {
namespace {

/// Fragments that are fetched while others are worked on.
constexpr std::size_t kSlotsAhead = 8;
void prefetch(const Fragment& fragment) {
  constexpr std::size_t kCacheLine = 64;
  const auto* const bytes = reinterpret_cast<const std::byte*>(&fragment);
  for (std::size_t at = 0; at < sizeof fragment; at += kCacheLine) hwy::Prefetch(bytes + at);
}

/// Trims the slots for which `has_ray(slot)` is false, then fills in the others: `make(i, slot)`
/// for ray i, which keys it where there are keys.
template <class HasRay, class Make>
void fill(const Executor& executor, View<const Fragment> fragments, std::size_t slot_count,
          Keys keys, const HasRay& has_ray, const Make& make, RayBatch* batch) {
  LargeVector<std::uint8_t> empty(slot_count);
  executor.for_each_block(slot_count, kWorkGrain, [&](std::size_t begin, std::size_t end) {
    const HasRay has_one = has_ray;  // which no byte that is written can be part of
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
  executor.for_each(count, kWorkGrain, [&](std::size_t i) {
    make(i, batch->slots[i]);
    if (keyed) batch->pixels[i] = fragments[batch->slots[i] % fragments.size].pixel;
  });
}

}  // namespace

RayBatch make_sky_rays(const Executor& executor, View<const Fragment> fragments,
                       const EnvironmentView& sky, const Box& scene_bounds, SampleOf sample,
                       Keys keys) {
  RayBatch batch;
  batch.kind = RayKind::kShadow;
  const LightReach reach = light_reach(scene_bounds);
  const ShadowKeyLayout layout = shadow_key_layout(kSkyStrategies);
  batch.key_bits = layout.key_bits();
  const std::size_t slot_count = fragments.size * kSkyStrategies;
  LargeVector<Ray> chosen(slot_count);  // those of slots that have one
  const auto has_ray = [&](std::size_t slot) {
    const Fragment& f = fragments[slot % fragments.size];
    if (!takes_light(f)) return false;
    const auto strategy = static_cast<std::uint32_t>(slot / fragments.size);
    const LightSample seen = choose_in_sky(f, sky, strategy, sample);
    if (!faces_light(f, seen)) return false;
    chosen[slot] = shadow_ray(f, seen, reach);
    return true;
  };
  const auto make = [&](std::size_t i, std::size_t slot) {
    const Ray ray = batch.rays[i] = chosen[slot];
    if (keys == Keys::kNone) return;
    batch.lights[i] = static_cast<std::uint32_t>(slot / fragments.size);
    batch.places[i] = octahedral(ray.direction);
    batch.keys[i] = shadow_key(layout, batch.lights[i], batch.places[i]);
  };
  fill(executor, fragments, slot_count, keys, has_ray, make, &batch);
  return batch;
}

RayBatch make_bounce_rays(const Executor& executor, View<const Fragment> fragments, RayKind kind,
                          const Box& scene_bounds, Keys keys, View<const std::uint8_t> going_on) {
  RayBatch batch;
  batch.kind = kind;
  batch.key_bits = kBounceKeyBits;
  const bool mirrors = kind == RayKind::kReflection;
  const std::uint8_t bit = mirrors ? kReflects : kRefracts;
  const auto has_ray = [going_on, bit, fragments](std::size_t slot) {
    if (!going_on.empty()) return (going_on[slot] & bit) != 0;
    const Fragment& f = fragments[slot];
    return f.triangle != kInvalidId && (rays_of(f, scattered_parts(f)) & bit) != 0;
  };
  const auto make = [&](std::size_t i, std::size_t slot) {
    const Fragment& f = fragments[slot];
    if (i + kSlotsAhead < batch.slots.size()) prefetch(fragments[batch.slots[i + kSlotsAhead]]);
    const Scattering s = scattered_parts(f);
    const Vec3 direction = mirrors ? mirror_direction(f) : refracted(f, cos_arrival(f));
    batch.weights[i] = f.weight * (mirrors ? s.reflected_part : s.refracted_part);
    batch.rays[i] = {offset_point(f.surface, direction, 0), 0, direction,
                     std::numeric_limits<float>::infinity()};
    if (keys == Keys::kMade)
      batch.keys[i] = bounce_key(scene_bounds, batch.rays[i].origin, direction);
  };
  fill(executor, fragments, fragments.size, keys, has_ray, make, &batch);
  return batch;
}

}  // namespace raysheaf
