// Tests one ray with boxes, in code without SIMD or bundles.
//
//   lo_x - pad      hi_x + pad        s: distance from the origin along the ray's longest axis,
//      |      _ - '    |                 t = s / |d_z|
//      |_ - '          |
//   _ -+---------------+------> s     in the slab from s0 to s1; in the box where all slabs overlap
//      s0              s1
//
// Conservative like bundles (methods/dual/bundle16.h): the error that a test may make grows with
// the distance from the ray to the box and with the origin's coordinates. Along an axis s is
// fma(plane, per, from), where `from` is -(origin -+ pad) per, with these rounding errors:
//
//   origin -+ pad, and that times `per`      u times the origin's coordinate each
//   a slope and its inverse, in `per`, and the fused operation    3 u of s
//
// The pad along an axis is 4 u times the origin's coordinate, and kFarther is more than 3 u at
// either end. Where slopes are too small for an inverse, and where s is below 0, the least of
// `Growth` is enough, with more for the larger slopes that are replaced here. The origins of rays
// that begin far outside the scene are moved (methods/dual/far_ray.h); so coordinates are at most
// 2^60, `per` is at most 2^67, and nothing overflows.
#pragma once

#include <cmath>
#include <limits>

#include "base/float.h"
#include "base/lesser.h"
#include "base/vec.h"
#include "geom/rounding.h"
#include "methods/dual/far_ray.h"

namespace raysheaf {

inline constexpr float kLargestOrigin = 0x1p60f, kRayLeastSlope = 0x1p-67f;

/// A ray prepared for tests with boxes.
struct BoxRay {
  Vec3 per;                  ///< s per unit of x, y, z
  Vec3 from_low, from_high;  ///< s of the coordinate 0, for lower and upper planes
  float s_near, s_far;       ///< interval in which boxes matter
  float along, start;        ///< |d_z|, and of a moved origin as in `FarRay`
};

RAYSHEAF_HD inline float distance_per_unit(float slope) {
  const float size = std::fabs(slope);
  const float per = 1 / (size > kRayLeastSlope ? size : kRayLeastSlope);
  return slope < 0 ? -per : per;
}

/// Sets what tests need with boxes within `bounds`, which grow by `pad` besides. `r` has `along`.
RAYSHEAF_HD inline void aim(Vec3 origin, Vec3 slope, float pad, const Box& bounds, BoxRay* r) {
  Growth growth(bounds);
  growth.include(r->along);
  const float least = growth.least + max_component(bounds.max - bounds.min) * 0x1p-58f + pad;
  const Vec3 off = abs(origin) * (4 * kUnitRoundoff) + Vec3{least, least, least};
  r->per = {distance_per_unit(slope.x), distance_per_unit(slope.y), distance_per_unit(slope.z)};
  r->from_low = -(origin + off) * r->per;
  r->from_high = -(origin - off) * r->per;
}

/// `scene` must contain all boxes that the ray is tested with.
RAYSHEAF_HD inline BoxRay make_box_ray(const Ray& ray, const Box& scene) {
  const Vec3 d = ray.direction, size = scene.max - scene.min;
  Vec3 o = ray.origin;
  BoxRay r;
  r.along = max_component(abs(d));
  r.start = 0;
  const float begin = ray.t_min < kLargeStart ? ray.t_min : 0;
  r.s_near = (begin - kLeastStep) * r.along * (1 - 8 * kUnitRoundoff);
  r.s_far = past(ray.t_max, r.along);
  float pad = 0;
  if (distance_outside(o, scene) > kFarLengths * max_component(size) ||
      max_component(abs(o)) > kLargestOrigin) {
    const FarRay far = move_origin(long_ray(ray, scene), ray.t_min, ray.t_max, r.along, scene);
    o = far.origin;
    pad = far.pad;
    r.s_near = 0, r.s_far = far.s_far, r.start = far.start;
  }
  aim(o, d / r.along, pad, scene, &r);
  return r;
}

/// A ray in the space of a mesh whose corners are in `bounds`, with its origin moved to there.
/// Returns whether it may meet them within [t_min, t_max].
RAYSHEAF_HD inline bool move_into(const LongRay& ray, float t_min, float t_max, const Box& bounds,
                                  BoxRay* r) {
  double along = 0;
  for (const double d : ray.direction) along = std::fabs(d) > along ? std::fabs(d) : along;
  const FarRay far = move_origin(ray, t_min, t_max, along, bounds);
  if (!(far.s_far >= 0)) return false;
  const double per = 1 / along;
  const auto slope = [&](int axis) { return static_cast<float>(ray.direction[axis] * per); };
  r->along = rounded_up(along);
  r->s_near = 0, r->s_far = far.s_far, r->start = far.start;
  aim(far.origin, {slope(0), slope(1), slope(2)}, far.pad, bounds, r);
  return true;
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
  return *near <= lesser(leave, lesser(greater(z0, z1), ray.s_far)) * kFarther;
}

/// Shortens the ray after a hit at `t`.
RAYSHEAF_HD inline void shorten(BoxRay* ray, float t) {
  const float far = past(t, ray->along) - ray->start;
  if (far < ray->s_far) ray->s_far = far;
}

}  // namespace raysheaf
