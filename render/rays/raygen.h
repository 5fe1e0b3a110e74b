// Stage 2: the rays that leave fragments, each with its sort key.
//
// A slot is a possible ray: a fragment, or a (light, fragment) pair, sorted by light, so that the
// slots of one light are in raster order. A scan (`trim`) removes slots without a ray; they make no
// key. O(slots).
//
// `dual` and brute force use only the rays: making a batch without keys costs half as much.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "raysheaf/large_vector.h"
#include "raysheaf/scene_description.h"
#include "raysheaf/statistics.h"
#include "render/rays/fragment.h"
#include "render/rays/light_body.h"
#include "render/rays/sample_body.h"
#include "render/surface/environment_body.h"

namespace raysheaf {

/// Whether a batch also has keys.
enum class Keys : std::uint8_t { kNone, kMade };

struct RayBatch {
  RayKind kind = RayKind::kShadow;
  std::uint32_t bounce = 1;
  std::uint32_t key_bits = 32;
  std::uint32_t width = 1;           ///< of the image in which `pixels` are numbered; set by the
                                     ///< caller
  LargeVector<std::uint32_t> slots;  ///< of each ray, ascending
  LargeVector<Ray> rays;
  /// Only for shadow rays: where the rays of each light end; those of the first start at 0.
  std::vector<std::uint32_t> light_ends;
  /// Only for reflections and refractions: the factor with which a ray's radiance is added to its
  /// pixel.
  LargeVector<Vec3> weights;
  // Only with `Keys::kMade`, one for each ray.
  LargeVector<std::uint32_t> keys;
  LargeVector<std::uint32_t> pixels;
  LargeVector<std::uint32_t> lights;  ///< only for shadow rays
  /// Only for shadow rays: the direction on the unit square, or the place on a directional light's
  /// disc.
  LargeVector<Vec2> places;
  bool part = false;        ///< a part of its stage's rays; other batches have the rest
  bool tells_plan = true;   ///< whether the method describes the plan
  bool names_hits = false;  ///< only for shadow rays: their hits must be named, not only their
                            ///< existence
};

/// The slots with `empty[i] == 0`, ascending: place p of the trimmed stream holds slot
/// `trim(...)[p]`.
[[nodiscard]] LargeVector<std::uint32_t> trim(const Executor& executor,
                                              View<const std::uint8_t> empty);

/// "shadow rays, bounce 1", for the progress of a frame.
[[nodiscard]] std::string stage_name(RayKind kind, std::uint32_t bounce);

/// Some rays of a batch: `taken(column)` returns each column's part, and an empty one of an empty
/// column. The caller sets `light_ends`.
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

/// Rays from lights to fragments, `t` from 0 at the light (or outside the scene, for directional
/// lights) to 1 just before the fragment; only if the shading normal faces the light and the light
/// reaches it. The sample chooses the point on lights with a size. Slot: light * fragments +
/// fragment, over the lights [first_light, first_light + light_count).
[[nodiscard]] RayBatch make_shadow_rays(const Executor& executor, View<const Fragment> fragments,
                                        View<const PlacedLight> lights, std::uint32_t first_light,
                                        std::uint32_t light_count, const Box& scene_bounds,
                                        SampleOf sample = {}, Keys keys = Keys::kMade);

/// Rays from an environment to fragments, from outside the scene: two per fragment, slot strategy *
/// fragments + fragment (environment_body.h).
[[nodiscard]] RayBatch make_sky_rays(const Executor& executor, View<const Fragment> fragments,
                                     const EnvironmentView& sky, const Box& scene_bounds,
                                     SampleOf sample, Keys keys = Keys::kMade);

/// `kind`: one that `bounce` (scatter_body.h) makes. Slot: the fragment. `going_on`: `rays_of` of
/// each fragment, if known.
[[nodiscard]] RayBatch make_bounce_rays(const Executor& executor, View<const Fragment> fragments,
                                        RayKind kind, const Box& scene_bounds,
                                        Keys keys = Keys::kMade,
                                        View<const std::uint8_t> going_on = {});

}  // namespace raysheaf
