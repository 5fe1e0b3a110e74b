// Where a ray ends for those who look for hits: at t_max, or where it leaves the scene.
//
//     +---------- scene, grown by `pad` ---+
//     |    o---------------------------->[e]        [e]: the box that is returned
//     +------------------------------------+
//
// What a hit says. The line of the ray meets the triangle in exact arithmetic, at a parameter s,
// and t is s rounded once, to within 1.25 u (intersect/triangle_body.h). With L the largest
// coordinate of a corner of the triangle as seen from the ray's origin, s |d| is no more than L
// along any axis; so the line's point at t lies within gamma(2) L of the triangle on every axis.
// Where t underflows it is off by 2^-149. Every triangle lies in the scene's box, and L is at most
// `size` below but for a rounding. So the line's point at s lies in the box grown by `pad`, and s
// is at most the parameter at which the ray leaves that box. A ray that misses it has no hits,
// whatever is returned; its end is its origin.
#pragma once

#include <cmath>
#include <limits>

#include "base/float.h"
#include "base/vec.h"

namespace raysheaf {

inline constexpr float kEndSlack = 64 * kUnitRoundoff;
/// Added to every slack, for what is lost to underflow.
inline constexpr float kTinySlack = 0x1p-60f;

RAYSHEAF_HD inline Box box_union(const Box& a, const Box& b) {
  return {min(a.min, b.min), max(a.max, b.max)};
}

/// The parameters at which a ray is between two planes across an axis, both as seen from its
/// origin.
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

/// A box that holds o + d min(t_max, s), s as above, and is no larger than rounding makes it. Every
/// point of the ray that a hit can be near lies between the origin and some point of the box.
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
  exit *= 1 + gamma(4);  // the distances of the planes and the quotients are rounded
  if (!(enter * (1 - gamma(4)) <= exit)) return {o, o};
  // A direction so short that its parameters overflow: anywhere in the scene.
  const Vec3 around{pad, pad, pad};
  if (!(exit < kLargest)) return box_union({o, o}, {scene.min - around, scene.max + around});
  const Vec3 step = d * exit, e = o + step;
  constexpr float kSmallest = std::numeric_limits<float>::min();
  const Vec3 error =
      (abs(step) + abs(e)) * (4 * kUnitRoundoff) + Vec3{kSmallest, kSmallest, kSmallest};
  return {e - error, e + error};
}

/// The farthest a point of a box is from `origin`, axis by axis, from above.
RAYSHEAF_HD inline Vec3 farthest(const Box& box, Vec3 origin) {
  return max(abs(box.min - origin), abs(box.max - origin)) * (1 + gamma(4));
}

}  // namespace raysheaf
