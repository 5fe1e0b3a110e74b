// Cones of directions: extending by a direction, merging, measuring.
//
// A cone stores the sine of its half angle. Bundles of coherent rays have angles near zero, where a
// float32 cosine cannot distinguish angles below 3e-4, but a sine can. No trigonometric function is
// called, so that all devices compute the same bits.
#pragma once

#include <cmath>

#include "base/float.h"
#include "base/vec.h"

namespace raysheaf {

/// Directions within an angle of at most 90 degrees from a unit axis. `sin_angle > 1` means all
/// directions: wider cones are not distinguished.
struct Cone {
  Vec3 axis{0, 0, 1};
  float sin_angle = 2;

  [[nodiscard]] RAYSHEAF_HD bool whole() const { return sin_angle > 1; }
};

/// sqrt(1 - x^2) for x in [0, 1], without cancellation near 1.
RAYSHEAF_HD inline float cosine_of_sine(float s) {
  const float square = (1 - s) * (1 + s);
  return square > 0 ? std::sqrt(square) : 0;
}

/// Enlarges a measured sine by its error: a cross product of two unit vectors, each with a length
/// within gamma(3) of 1, has an absolute error below gamma(8).
RAYSHEAF_HD inline float sine_grown(float s) {
  return s + gamma(16);
}

/// A cone during extension: it stores both functions of its angle, which may exceed 90 degrees.
struct GrowingCone {
  Vec3 axis;
  float cos_angle = 1, sin_angle = 0;
};

/// The smallest cone that contains a cone and a unit direction (L. Szecsi, "The Hierarchical Ray
/// Engine", WSCG 2006; Reis et al. 2017, equations 1-4 with the norm that equation 1
/// lacks).
///
///     e   x   x'  r       e = x cos + q sin: the generator opposite to r,
///      \  |  /  .         q perpendicular to x, away from r;
///       \ | / .           x' bisects e and r.
///        \|/.
RAYSHEAF_HD inline GrowingCone extended(const GrowingCone& cone, Vec3 r) {
  const float c = dot(cone.axis, r);
  const Vec3 away = cone.axis * c - r;
  const float norm = length(away);
  // The sine is accurate for narrow angles, the cosine for wide ones.
  const bool inside = cone.cos_angle > 0.5f ? c > 0 && norm <= cone.sin_angle : c >= cone.cos_angle;
  if (inside || !(norm > 0)) return cone;
  const Vec3 e = cone.axis * cone.cos_angle + away * (cone.sin_angle / norm);
  const Vec3 axis = normalized(e + r, cone.axis);
  return {axis, dot(axis, r), length(cross(axis, r))};
}

/// The sine of the angle between a unit axis and the farthest direction of a cone, or 2 beyond 90
/// degrees, by the addition theorems for sin(t + a) and cos(t + a).
RAYSHEAF_HD inline float farthest_sine(Vec3 axis, const Cone& cone) {
  if (cone.whole()) return 2;
  const float sin_between = length(cross(axis, cone.axis));
  const float cos_between = dot(axis, cone.axis);
  const float cos_angle = cosine_of_sine(cone.sin_angle);
  const float cos_sum = cos_between * cos_angle - sin_between * cone.sin_angle;
  if (!(cos_sum > gamma(16))) return 2;
  return sin_between * cos_angle + cos_between * cone.sin_angle;
}

/// The axis of the smallest cone that contains two cones (the union of pbrt-v4's DirectionCone,
/// 2023, by bisecting the outer generators instead of a rotation). Equation 5 of the paper uses the
/// mean of the axes.
RAYSHEAF_HD inline Vec3 union_axis(const Cone& a, const Cone& b) {
  if (a.whole() || b.whole()) return a.axis;
  const float cos_a = cosine_of_sine(a.sin_angle), cos_b = cosine_of_sine(b.sin_angle);
  const float c = dot(a.axis, b.axis), s = length(cross(a.axis, b.axis));
  if (c * cos_b - s * b.sin_angle >= cos_a) return a.axis;  // b is contained in a
  if (c * cos_a - s * a.sin_angle >= cos_b) return b.axis;
  if (!(s > 0)) return a.axis;
  const Vec3 from_b = normalized(a.axis * c - b.axis, a.axis);
  const Vec3 from_a = normalized(b.axis * c - a.axis, b.axis);
  const Vec3 outer_a = a.axis * cos_a + from_b * a.sin_angle;
  const Vec3 outer_b = b.axis * cos_b + from_a * b.sin_angle;
  return normalized(outer_a + outer_b, a.axis);
}

}  // namespace raysheaf
