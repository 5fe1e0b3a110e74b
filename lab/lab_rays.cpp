#include "lab/lab_rays.h"

#include <limits>
#include <numbers>

#include "render/rays/hash_body.h"
#include "render/rays/offset_body.h"
#include "render/rays/scatter_body.h"

namespace raysheaf {
namespace {

/// Removes slots whose fragment has no surface, then fills the rest: `direction(fragment, slot)` is
/// a unit vector.
template <class Direction>
RayBatch make_rays(const Executor& executor, View<const Fragment> fragments, std::uint32_t samples,
                   const Box& scene_bounds, float length, const Direction& direction) {
  RayBatch batch;
  batch.key_bits = kBounceKeyBits;
  std::vector<std::uint8_t> empty(fragments.size * samples);
  executor.for_each(empty.size(), kWorkGrain, [&](std::size_t slot) {
    empty[slot] = fragments[slot % fragments.size].triangle == kInvalidId ? 1 : 0;
  });
  batch.slots = trim(executor, empty);
  batch.rays.resize(batch.slots.size());
  batch.keys.resize(batch.slots.size());
  batch.pixels.resize(batch.slots.size());
  executor.for_each(batch.slots.size(), kWorkGrain, [&](std::size_t i) {
    const std::uint32_t slot = batch.slots[i];
    const Fragment& f = fragments[slot % fragments.size];
    const Vec3 d = direction(f, slot);
    batch.rays[i] = {offset_point(f.surface, d, 0), 0, d, length};
    batch.keys[i] = bounce_key(scene_bounds, batch.rays[i].origin, d);
    batch.pixels[i] = f.pixel;
  });
  return batch;
}

/// M. O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for
/// Random Number Generation", 2014: one step of the 32-bit generator, and its output permutation.
std::uint32_t hashed(std::uint32_t x) {
  const std::uint32_t state = x * 747796405u + 2891336453u;
  const std::uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
  return (word >> 22) ^ word;
}

/// [0, 1), from the upper bits, as many as a float has.
float unit_interval(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24f;
}

/// A uniform point of the unit disc, lifted to the hemisphere (Malley's method). If the shading
/// normal is tilted, a direction below the surface is mirrored above it.
Vec3 cosine_direction(const Surface& surface, float u, float v) {
  const float radius = std::sqrt(u), angle = 2 * std::numbers::pi_v<float> * v;
  const Vec3 n = surface.normal;
  const Vec3 side =
      normalized(cross(std::fabs(n.x) < 0.5f ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, n), {1, 0, 0});
  const Vec3 d = normalized(side * (radius * std::cos(angle)) +
                                cross(n, side) * (radius * std::sin(angle)) + n * std::sqrt(1 - u),
                            n);
  const float height = dot(d, surface.geometric_normal);
  return height > 0 ? d : normalized(d - surface.geometric_normal * (2 * height), n);
}

}  // namespace

RayBatch make_mirror_rays(const Executor& executor, View<const Fragment> fragments,
                          const Box& scene_bounds, std::uint32_t bounce) {
  RayBatch batch =
      make_rays(executor, fragments, 1, scene_bounds, std::numeric_limits<float>::infinity(),
                [](const Fragment& f, std::uint32_t) { return mirror_direction(f); });
  batch.kind = RayKind::kReflection;
  batch.bounce = bounce;
  return batch;
}

RayBatch make_occlusion_rays(const Executor& executor, View<const Fragment> fragments,
                             const Box& scene_bounds, float length) {
  const auto direction = [&](const Fragment& f, std::uint32_t slot) {
    const auto sample = static_cast<std::uint32_t>(slot / fragments.size);
    const std::uint32_t first = hashed(f.pixel * kOcclusionRays + sample), second = hashed(first);
    const std::uint32_t column = sample % 2, row = sample / 2;  // of strata
    const float u = (static_cast<float>(column) + unit_interval(first)) / 2;
    const float v = (static_cast<float>(row) + unit_interval(second)) / 2;
    return cosine_direction(f.surface, u, v);
  };
  RayBatch batch = make_rays(executor, fragments, kOcclusionRays, scene_bounds, length, direction);
  batch.kind = RayKind::kAmbientOcclusion;
  return batch;
}

}  // namespace raysheaf
