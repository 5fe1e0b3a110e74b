// Stage 2: the rays that leave fragments, each with its sort key.
//
// A slot is a place where a ray may stand: a fragment, or a (light, fragment) pair with the light
// first, so that the slots of one light are in raster order. Slots without a ray are trimmed away
// by a scan (rays/order/order.h); they make no key. O(slots).
//
// `dual` and brute force look at the rays alone: made without keys, a batch costs half as much.
#pragma once

#include <cstdint>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "rays/fragment.h"
#include "rays/light_body.h"
#include "rays/sample_body.h"
#include "raysheaf/large_vector.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/statistics.h"
#include "surface/environment_body.h"

namespace raysheaf {

/// What beside its rays a batch is made with.
enum class Keys : std::uint8_t { kNone, kMade };

struct RayBatch {
  RayKind kind = RayKind::kShadow;
  std::uint32_t bounce = 1;
  std::uint32_t key_bits = 32;
  std::uint32_t width = 1;           ///< of the picture that `pixels` counts in; the caller sets it
  LargeVector<std::uint32_t> slots;  ///< of each ray, ascending
  LargeVector<Ray> rays;
  /// Shadow rays alone: where the rays of each light end, those of the first from 0 on.
  std::vector<std::uint32_t> light_ends;
  /// Reflections and refractions alone: what a ray's pixel receives of the radiance along it.
  LargeVector<Vec3> weights;
  // With `Keys::kMade` alone, a ray each.
  LargeVector<std::uint32_t> keys;
  LargeVector<std::uint32_t> pixels;
  LargeVector<std::uint32_t> lights;  ///< shadow rays alone
  /// Shadow rays alone: the direction on the unit square, or the place on a parallel light's disc.
  LargeVector<Vec2> places;
  bool part = false;        ///< of its stage's rays; other batches have the rest
  bool tells_plan = true;   ///< how it is traced is put into words, where a method plans
  bool names_hits = false;  ///< shadow rays alone: not only whether they meet something is asked
};

/// Some rays of a batch: `taken(column)` has what each column has of them, and nothing of one that
/// is empty. Where the rays of each light end is left to the caller.
template <class Taken>
[[nodiscard]] RayBatch part_of_batch(const RayBatch& batch, const Taken& taken) {
  RayBatch part;
  part.kind = batch.kind;
  part.bounce = batch.bounce;
  part.key_bits = batch.key_bits;
  part.width = batch.width;
  part.names_hits = batch.names_hits;
  part.slots = taken(batch.slots);
  part.rays = taken(batch.rays);
  part.weights = taken(batch.weights);
  part.keys = taken(batch.keys);
  part.pixels = taken(batch.pixels);
  part.lights = taken(batch.lights);
  part.places = taken(batch.places);
  return part;
}

/// Rays from lights to fragments, `t` from 0 at the light (or beyond the scene, for parallel light)
/// to 1 just before the fragment; only where the shading normal faces the light and the light
/// reaches. Lights with a size are looked at where the sample says. Slot: light * fragments +
/// fragment, over the lights [first_light, first_light +
/// light_count).
[[nodiscard]] RayBatch make_shadow_rays(const Executor& executor, View<const Fragment> fragments,
                                        View<const PlacedLight> lights, std::uint32_t first_light,
                                        std::uint32_t light_count, const Box& scene_bounds,
                                        SampleOf sample = {}, Keys keys = Keys::kMade);

/// Rays from an environment to fragments, from beyond the scene: two a fragment, slot
/// strategy * fragments + fragment (environment_body.h).
[[nodiscard]] RayBatch make_sky_rays(const Executor& executor, View<const Fragment> fragments,
                                     const EnvironmentView& sky, const Box& scene_bounds,
                                     SampleOf sample, Keys keys = Keys::kMade);

/// `kind`: kReflection or kRefraction. Slot: the fragment. `going_on`: what `rays_of`
/// (scatter_body.h) says of each fragment, where that is known.
[[nodiscard]] RayBatch make_bounce_rays(const Executor& executor, View<const Fragment> fragments,
                                        RayKind kind, const Box& scene_bounds,
                                        Keys keys = Keys::kMade,
                                        View<const std::uint8_t> going_on = {});

}  // namespace raysheaf
