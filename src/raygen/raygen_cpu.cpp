#include "order/order.h"
#include "raygen/hash_body.h"
#include "raygen/raygen.h"
#include "raygen/scatter_body.h"
#include "raygen/shadow_body.h"
#include "raygen/sky_body.h"

namespace raysheaf {
namespace {

/// Trims the slots for which `has_ray(slot)` is false, then fills rays and keys: `make(i, slot,
/// &ray, &key)` for ray i.
template <class HasRay, class Make>
void fill(const Executor& executor, View<const Fragment> fragments, std::size_t slot_count,
          const HasRay& has_ray, const Make& make, RayBatch* batch) {
  std::vector<std::uint8_t> empty(slot_count);
  executor.for_each(slot_count, kWorkGrain,
                    [&](std::size_t slot) { empty[slot] = has_ray(slot) ? 0 : 1; });
  batch->slots = trim(executor, empty);
  batch->rays.resize(batch->slots.size());
  batch->keys.resize(batch->slots.size());
  batch->pixels.resize(batch->slots.size());
  if (batch->kind == RayKind::kShadow) {
    batch->lights.resize(batch->slots.size());
    batch->places.resize(batch->slots.size());
  }
  executor.for_each(batch->slots.size(), kWorkGrain, [&](std::size_t i) {
    make(i, batch->slots[i], &batch->rays[i], &batch->keys[i]);
    batch->pixels[i] = fragments[batch->slots[i] % fragments.size].pixel;
  });
}

}  // namespace

RayBatch make_shadow_rays(const Executor& executor, View<const Fragment> fragments,
                          View<const Light> lights, std::uint32_t first_light,
                          std::uint32_t light_count, const Box& scene_bounds, SampleOf sample) {
  RayBatch batch;
  batch.kind = RayKind::kShadow;
  const LightReach reach = light_reach(scene_bounds);
  const ShadowKeyLayout layout = shadow_key_layout(static_cast<std::uint32_t>(lights.size));
  batch.key_bits = layout.key_bits();
  const auto has_ray = [&](std::size_t slot) {
    const Fragment& f = fragments[slot % fragments.size];
    const auto index = static_cast<std::uint32_t>(first_light + slot / fragments.size);
    return f.triangle != kInvalidId &&
           faces_light(f, choose_on_light(f, lights[index], index, sample));
  };
  const auto make = [&](std::size_t i, std::size_t slot, Ray* ray, std::uint32_t* key) {
    const Fragment& f = fragments[slot % fragments.size];
    const auto index = static_cast<std::uint32_t>(first_light + slot / fragments.size);
    const Light& light = lights[index];
    *ray = shadow_ray(f, choose_on_light(f, light, index, sample), reach);
    batch.lights[i] = index;
    batch.places[i] = shadow_place(light, *ray, reach);
    *key = shadow_key(layout, index, batch.places[i]);
  };
  fill(executor, fragments, fragments.size * light_count, has_ray, make, &batch);
  return batch;
}

RayBatch make_sky_rays(const Executor& executor, View<const Fragment> fragments,
                       const EnvironmentView& sky, const Box& scene_bounds, SampleOf sample) {
  RayBatch batch;
  batch.kind = RayKind::kShadow;
  const LightReach reach = light_reach(scene_bounds);
  const ShadowKeyLayout layout = shadow_key_layout(kSkyStrategies);
  batch.key_bits = layout.key_bits();
  const auto choose = [&](std::size_t slot) {
    const auto strategy = static_cast<std::uint32_t>(slot / fragments.size);
    return choose_in_sky(fragments[slot % fragments.size], sky, strategy, sample);
  };
  const auto has_ray = [&](std::size_t slot) {
    const Fragment& f = fragments[slot % fragments.size];
    return f.triangle != kInvalidId && faces_light(f, choose(slot));
  };
  const auto make = [&](std::size_t i, std::size_t slot, Ray* ray, std::uint32_t* key) {
    *ray = shadow_ray(fragments[slot % fragments.size], choose(slot), reach);
    batch.lights[i] = static_cast<std::uint32_t>(slot / fragments.size);
    batch.places[i] = octahedral(ray->direction);
    *key = shadow_key(layout, batch.lights[i], batch.places[i]);
  };
  fill(executor, fragments, fragments.size * kSkyStrategies, has_ray, make, &batch);
  return batch;
}

RayBatch make_bounce_rays(const Executor& executor, View<const Fragment> fragments, RayKind kind,
                          const Box& scene_bounds) {
  RayBatch batch;
  batch.kind = kind;
  batch.key_bits = kBounceKeyBits;
  const bool mirrors = kind == RayKind::kReflection;
  const auto has_ray = [&](std::size_t slot) {
    const Fragment& f = fragments[slot];
    if (f.triangle == kInvalidId) return false;
    const Scattering s = scatter(f);
    return worth_tracing(f.weight * (mirrors ? s.reflected_part : s.refracted_part)) &&
           (s.mirror || !mirrors);
  };
  const auto make = [&](std::size_t /*i*/, std::size_t slot, Ray* ray, std::uint32_t* key) {
    const Fragment& f = fragments[slot];
    const Scattering s = scatter(f);
    const Vec3 direction = mirrors ? s.reflection : s.refraction;
    *ray = {offset_point(f.surface, direction, 0), 0, direction,
            std::numeric_limits<float>::infinity()};
    *key = bounce_key(scene_bounds, ray->origin, direction);
  };
  fill(executor, fragments, fragments.size, has_ray, make, &batch);
  return batch;
}

}  // namespace raysheaf
