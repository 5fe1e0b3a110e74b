// Makes one shadow ray.
#pragma once

#include <limits>

#include "render/rays/fragment.h"
#include "render/rays/hash_body.h"
#include "render/rays/light_body.h"
#include "render/rays/offset_body.h"

namespace raysheaf {

/// The scene's box, outside which directional light starts, and the sphere around it.
struct LightReach {
  Box bounds;
  Vec3 center;
  float radius;
};

RAYSHEAF_HD inline LightReach light_reach(const Box& bounds) {
  return {bounds, (bounds.min + bounds.max) * 0.5f, length(bounds.max - bounds.min) * 0.5f};
}

/// A distance from a point inside the box to outside it, with room for the rounding of both ends
/// and of a triangle in the box's wall.
RAYSHEAF_HD inline float way_out(const Box& bounds, Vec3 from, Vec3 direction) {
  float way = std::numeric_limits<float>::infinity();
  const auto clip = [&](float low, float high, float at, float along) {
    if (along == 0) return;
    const float end = ((along < 0 ? low : high) - at) / along;
    way = end < way ? end : way;
  };
  clip(bounds.min.x, bounds.max.x, from.x, direction.x);
  clip(bounds.min.y, bounds.max.y, from.y, direction.y);
  clip(bounds.min.z, bounds.max.z, from.z, direction.z);
  const float size = max_component(max(abs(bounds.min), abs(bounds.max)));
  return (way > 0 ? way : 0) * (1 + 64 * kUnitRoundoff) + 64 * kUnitRoundoff * size;
}

/// Whether there is a surface on which light falls.
RAYSHEAF_HD inline bool takes_light(const Fragment& f) {
  return f.triangle != kInvalidId && !f.surface.unlit;
}

/// n.l > 0 with the shading normal, as in the paper, and light that is not black.
RAYSHEAF_HD inline bool faces_light(const Fragment& f, const LightSample& sample) {
  return takes_light(f) && dot(f.surface.normal, sample.to_light) > 0 &&
         max_component(sample.irradiance) > 0;
}

/// Whether all points of a light with a size are behind the surface: then no sample of it faces the
/// light, with any rounding. False means undecided.
inline bool turned_away(const Surface& surface, const PlacedLight& light) {
  const Vec3 to_center = light.position - surface.position, n = surface.normal;
  float extent = light.radius;
  if (light.is_rectangle) {
    const Vec3 up = cross(light.right, light.direction);
    extent = 0.5f *
             (std::fabs(dot(n, light.right)) * light.width + std::fabs(dot(n, up)) * light.height);
  }
  const float size = length(to_center) + light.radius + light.width + light.height;
  const float margin = 1e-4f * size + 1e-6f * max_component(abs(light.position));
  return dot(n, to_center) + extent < -margin;
}

/// The point on light number `index` of the scene that the fragment chooses in this sample. A
/// single sample has no choice: a sphere then emits light from its centre, like a point.
RAYSHEAF_HD inline LightSample choose_on_light(const Fragment& f, const PlacedLight& light,
                                               std::uint32_t index, SampleOf sample) {
  if (!has_size(light)) return sample_light(light, f.surface.position);
  if (sample.count == 1 && !light.is_rectangle) return sample_point(light, f.surface.position);
  const std::uint32_t seed = choice_seed(Choice::kLight, f.pixel, f.path, index);
  return sample_light(light, f.surface.position, sample_pair(sample, seed));
}

/// From the light to just before the fragment.
RAYSHEAF_HD inline Ray shadow_ray(const Fragment& f, const LightSample& sample,
                                  const LightReach& reach) {
  const bool parallel = !std::isfinite(sample.distance);
  // From just outside the scene: the longer the ray, the farther from the surface it ends.
  const float distance =
      parallel ? way_out(reach.bounds, f.surface.position, sample.to_light) : sample.distance;
  const Vec3 target = offset_point(f.surface, sample.to_light, distance);
  const Vec3 origin = parallel ? target + sample.to_light * distance : sample.point;
  return {origin, 0, target - origin, 1};
}

/// The ray's place on the unit square of its key: the direction in which it leaves its light or,
/// for directional lights, the place on the disc through which the light shines.
RAYSHEAF_HD inline Vec2 shadow_place(const PlacedLight& light, const Ray& ray,
                                     const LightReach& reach) {
  if (!light.is_directional) return octahedral(ray.direction);
  const Vec3 n = light.direction;
  const Vec3 side = std::fabs(n.x) < 0.5f ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalized(cross(n, side)), v = cross(n, u);
  const Vec3 from_center = ray.origin - reach.center;
  const float scale = reach.radius > 0 ? 0.5f / reach.radius : 0;
  return {dot(from_center, u) * scale + 0.5f, dot(from_center, v) * scale + 0.5f};
}

}  // namespace raysheaf
