// One ray with boxes, where neither SIMD nor a packet is.
//
//   lo_x - pad      hi_x + pad        s: distance from the origin along the ray's longest axis,
//      |      _ - '    |                 t = s / |d_z|
//      |_ - '          |
//   _ -+---------------+------> s     in the slab from s0 to s1; in the box where all slabs overlap
//      s0              s1
//
// Conservative as packets are, with the same pad for the same reasons (dual/packet.h): a slope's
// and its inverse's roundings, that of the plane's difference and that of their product are four in
// place of three, each at most u times `size`, and the pad has room for a hundred.
#pragma once

#include <cmath>
#include <limits>

#include "base/float.h"
#include "base/vec.h"
#include "geom/ray_end.h"

namespace raysheaf {

/// The limits of packets (dual/packet.h), for one ray: coordinates and reaches beyond are not
/// bounded; what a t that underflows may be off by; from where t_min bounds nothing.
inline constexpr float kRayLargestBounded = 1e30f;
inline constexpr float kRayLeastStep = 0x1p-148f;
inline constexpr float kRayLargeStart = 0x1p63f;

/// The s from which on no hit is as near as t: `along` is |d_z|.
[[nodiscard]] RAYSHEAF_HD inline float end_beyond(float t, float along, float pad) {
  return (t + kRayLeastStep) * along * (1 + 8 * kUnitRoundoff) + pad;
}

/// A ray made ready for boxes.
struct BoxRay {
  Vec3 low, high;       ///< the origin, for lower and upper planes, which the pad moves outwards
  Vec3 per;             ///< s for a unit of x, y, z
  float s_near, s_far;  ///< where boxes matter
  float along, pad;
  bool bounded;  ///< or else every triangle is tested
};

RAYSHEAF_HD inline float distance_per_unit(float direction, float along) {
  constexpr float kLeastSlope = 1e-20f;
  const float slope = direction / along, size = std::fabs(slope);
  const float per = 1 / (size > kLeastSlope ? size : kLeastSlope);
  return slope < 0 ? -per : per;
}

/// `scene` has all boxes that it will meet.
RAYSHEAF_HD inline BoxRay make_box_ray(const Ray& ray, const Box& scene) {
  const Vec3 o = ray.origin, d = ray.direction;
  const float reach = max_component(max(abs(o - scene.min), abs(o - scene.max)));
  const float size = 2 * reach, largest = max_component(abs(o)) + size;
  BoxRay r;
  r.bounded = largest <= kRayLargestBounded;
  r.pad = 128 * kUnitRoundoff * size + 8 * kUnitRoundoff * largest + kTinySlack;
  r.along = max_component(abs(d));
  const Vec3 pad{r.pad, r.pad, r.pad};
  r.low = o + pad;
  r.high = o - pad;
  r.per = {distance_per_unit(d.x, r.along), distance_per_unit(d.y, r.along),
           distance_per_unit(d.z, r.along)};
  const float start = ray.t_min < kRayLargeStart ? ray.t_min : 0;
  r.s_near = (start - kRayLeastStep) * r.along * (1 - 8 * kUnitRoundoff) - r.pad;
  r.s_far = end_beyond(ray.t_max, r.along, r.pad);
  return r;
}

/// Whether the ray may meet something in the box; where it enters it.
RAYSHEAF_HD inline bool enters(const BoxRay& ray, const Box& box, float* near) {
  const Vec3 to_low = (box.min - ray.low) * ray.per, to_high = (box.max - ray.high) * ray.per;
  const Vec3 first = min(to_low, to_high), last = max(to_low, to_high);
  const float enter = max_component(first), leave = min_component(last);
  *near = enter > ray.s_near ? enter : ray.s_near;
  return *near <= (leave < ray.s_far ? leave : ray.s_far);
}

/// A hit at `t`: what lies beyond does not matter any more.
RAYSHEAF_HD inline void shorten(BoxRay* ray, float t) {
  const float far = end_beyond(t, ray->along, ray->pad);
  if (far < ray->s_far) ray->s_far = far;
}

}  // namespace raysheaf
