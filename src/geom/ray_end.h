// The last point of a ray at which a hit is possible: at t_max, or where the ray leaves the scene.
//
//     +---------- scene, grown by `pad` ---+
//     |    o---------------------------->[e]        [e]: the box that is returned
//     +------------------------------------+
//
// Proof. For a hit, the line of the ray intersects the triangle in exact arithmetic, at a parameter
// s, and t is s rounded once, to within 1.25 u (intersect/triangle_body.h). Let L be the largest
// coordinate of a corner of the triangle relative to the ray's origin. Then s |d| is at most L
// along any axis, so the line's point at t lies within gamma(2) L of the triangle on every axis. If
// t underflows, its error is 2^-149. Every triangle lies in the scene's box, and L is at most
// `size` below, except for a rounding error. Therefore the line's point at s lies in the box grown
// by `pad`, and s is at most the parameter at which the ray leaves that box. A ray that misses the
// box has no hits, so its result does not matter; its end is its origin.
#pragma once

#include <cmath>
#include <limits>

#include "base/float.h"
#include "base/vec.h"

namespace raysheaf {

inline constexpr float kEndSlack = 64 * kUnitRoundoff;
/// Added to every slack, to cover underflow.
inline constexpr float kTinySlack = 0x1p-60f;

RAYSHEAF_HD inline Box box_union(const Box& a, const Box& b) {
  return {min(a.min, b.min), max(a.max, b.max)};
}

/// The parameters between which a ray lies between two planes across an axis, with both planes
/// given relative to its origin.
RAYSHEAF_HD inline void clip_to_slab(float lo, float hi, float direction, float* enter,
                                     float* exit) {
  if (direction == 0) {
    if (lo > 0 || hi < 0) *exit = -1;
    return;
  }
  const float near = (direction > 0 ? lo : hi) / direction;
  const float far = (direction > 0 ? hi : lo) / direction;
  *enter = near > *enter ? near : *enter;
  *exit = far < *exit ? far : *exit;
}

/// The smallest box, except for rounding, that contains o + d min(t_max, s), s as above. Every
/// point of the ray near which a hit may lie is between the origin and some point of the box.
RAYSHEAF_HD inline Box end_of(const Ray& ray, const Box& scene) {
  constexpr float kLargest = 1e38f;
  const Vec3 o = ray.origin, d = ray.direction;
  const Vec3 lo = scene.min - o, hi = scene.max - o;
  const float size = max_component(max(abs(lo), abs(hi)));
  const float pad = kEndSlack * size + kTinySlack;
  float enter = 0, exit = ray.t_max;
  clip_to_slab(lo.x - pad, hi.x + pad, d.x, &enter, &exit);
  clip_to_slab(lo.y - pad, hi.y + pad, d.y, &enter, &exit);
  clip_to_slab(lo.z - pad, hi.z + pad, d.z, &enter, &exit);
  exit *= 1 + gamma(4);  // accounts for the rounding of the planes' distances and of the quotients
  if (!(enter * (1 - gamma(4)) <= exit)) return {o, o};
  // The direction is so short that its parameters overflow: the end may be anywhere in the scene.
  const Vec3 around{pad, pad, pad};
  if (!(exit < kLargest)) return box_union({o, o}, {scene.min - around, scene.max + around});
  const Vec3 step = d * exit, e = o + step;
  constexpr float kSmallest = std::numeric_limits<float>::min();
  const Vec3 error =
      (abs(step) + abs(e)) * (4 * kUnitRoundoff) + Vec3{kSmallest, kSmallest, kSmallest};
  return {e - error, e + error};
}

/// An upper bound of the distance from `origin` to the points of a box, for each axis.
RAYSHEAF_HD inline Vec3 farthest(const Box& box, Vec3 origin) {
  return max(abs(box.min - origin), abs(box.max - origin)) * (1 + gamma(4));
}

}  // namespace raysheaf
