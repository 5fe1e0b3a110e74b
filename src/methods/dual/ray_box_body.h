// Tests one ray with boxes, in code without SIMD or bundles.
//
//   lo_x - pad      hi_x + pad        s: distance from the origin along the ray's longest axis,
//      |      _ - '    |                 t = s / |d_z|
//      |_ - '          |
//   _ -+---------------+------> s     in the slab from s0 to s1; in the box where all slabs overlap
//      s0              s1
//
// Conservative like bundles, with the same pad (methods/dual/bundle16.h). Along an axis s is
// fma(plane, per, from), where `from` is -(origin -+ pad) per, with these rounding errors:
//
//   origin -+ pad, and that times `per`      u times the largest coordinate each
//   the fused product and sum                u times `size`
//   a slope and its inverse, in `per`        u times the difference, which is at most `size`
//
// The pad covers 128 u `size` and 8 u the largest coordinate. Nothing overflows: coordinates are at
// most 2^60 and `per` is at most 2^67.
#pragma once

#include <cmath>
#include <limits>

#include "base/float.h"
#include "base/lesser.h"
#include "base/vec.h"
#include "geom/ray_end.h"

namespace raysheaf {

/// For single rays: larger coordinates and reaches are not bounded, because products with inverse
/// slopes would overflow. The other constants are as for bundles (methods/dual/bundle16.h): the
/// error of a t that underflows, and the t_min from which on it bounds nothing.
inline constexpr float kRayLargestBounded = 0x1p60f, kRayLeastSlope = 0x1p-67f;
inline constexpr float kRayLeastStep = 0x1p-148f;
inline constexpr float kRayLargeStart = 0x1p63f;

/// The s beyond which no hit is as near as t: `along` is |d_z|.
[[nodiscard]] RAYSHEAF_HD inline float end_beyond(float t, float along, float pad) {
  return (t + kRayLeastStep) * along * (1 + 8 * kUnitRoundoff) + pad;
}

/// A ray prepared for tests with boxes.
struct BoxRay {
  Vec3 per;                  ///< s per unit of x, y, z
  Vec3 from_low, from_high;  ///< s of the coordinate 0, for lower and upper planes
  float s_near, s_far;       ///< interval in which boxes matter
  float along, pad;
  bool bounded;  ///< false: every triangle is tested
};

RAYSHEAF_HD inline float distance_per_unit(float direction, float along) {
  const float slope = direction / along, size = std::fabs(slope);
  const float per = 1 / (size > kRayLeastSlope ? size : kRayLeastSlope);
  return slope < 0 ? -per : per;
}

/// `scene` must contain all boxes that the ray is tested with.
RAYSHEAF_HD inline BoxRay make_box_ray(const Ray& ray, const Box& scene) {
  const Vec3 o = ray.origin, d = ray.direction;
  const float reach = max_component(max(abs(o - scene.min), abs(o - scene.max)));
  const float size = 2 * reach, largest = max_component(abs(o)) + size;
  BoxRay r;
  r.bounded = largest <= kRayLargestBounded;
  r.pad = 128 * kUnitRoundoff * size + 8 * kUnitRoundoff * largest + kTinySlack;
  r.along = max_component(abs(d));
  const Vec3 pad{r.pad, r.pad, r.pad};
  r.per = {distance_per_unit(d.x, r.along), distance_per_unit(d.y, r.along),
           distance_per_unit(d.z, r.along)};
  r.from_low = -(o + pad) * r.per;
  r.from_high = -(o - pad) * r.per;
  const float start = ray.t_min < kRayLargeStart ? ray.t_min : 0;
  r.s_near = (start - kRayLeastStep) * r.along * (1 - 8 * kUnitRoundoff) - r.pad;
  r.s_far = end_beyond(ray.t_max, r.along, r.pad);
  return r;
}

/// Whether the ray may intersect anything in the box, and where it enters the box.
RAYSHEAF_HD inline bool enters(const BoxRay& ray, const Box& box, float* near) {
  const float x0 = std::fma(box.min.x, ray.per.x, ray.from_low.x);
  const float y0 = std::fma(box.min.y, ray.per.y, ray.from_low.y);
  const float z0 = std::fma(box.min.z, ray.per.z, ray.from_low.z);
  const float x1 = std::fma(box.max.x, ray.per.x, ray.from_high.x);
  const float y1 = std::fma(box.max.y, ray.per.y, ray.from_high.y);
  const float z1 = std::fma(box.max.z, ray.per.z, ray.from_high.z);
  const float enter = greater(lesser(x0, x1), lesser(y0, y1));
  const float leave = lesser(greater(x0, x1), greater(y0, y1));
  *near = greater(enter, greater(lesser(z0, z1), ray.s_near));
  return *near <= lesser(leave, lesser(greater(z0, z1), ray.s_far));
}

/// Shortens the ray after a hit at `t`.
RAYSHEAF_HD inline void shorten(BoxRay* ray, float t) {
  const float far = end_beyond(t, ray->along, ray->pad);
  if (far < ray->s_far) ray->s_far = far;
}

}  // namespace raysheaf
