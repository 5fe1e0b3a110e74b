// Bounding spheres: of a triangle, of two spheres, under an affine map.
#pragma once

#include "base/float.h"
#include "base/vec.h"

namespace raysheaf {

/// A sphere. Empty if `radius < 0`.
struct Sphere {
  Vec3 center;
  float radius = -1;
};

/// Enlarges a radius so that rounding errors in the measured distance cannot exclude a point: the
/// square root of a sum of three squares of differences has a relative error of at most gamma(4).
RAYSHEAF_HD inline float radius_grown(float distance) {
  return distance * (1 + 2 * gamma(4));
}

/// The minimum enclosing sphere of a triangle: its circumscribed sphere or, if the triangle is
/// obtuse, the diametral sphere of its longest edge (Ericson, Real-Time Collision Detection, 2005,
/// section 4.3, with the factor of `s` corrected). For any rounding of the centre, the radius
/// reaches all three vertices.
RAYSHEAF_HD inline Sphere triangle_sphere(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, ac = c - a;
  const float ab_ab = dot(ab, ab), ab_ac = dot(ab, ac), ac_ac = dot(ac, ac);
  const float d = 2 * (ab_ab * ac_ac - ab_ac * ab_ac);
  const float s = ab_ab * ac_ac - ac_ac * ab_ac;
  const float t = ac_ac * ab_ab - ab_ab * ab_ac;
  Vec3 center;
  if (!(s > 0)) {
    center = a + ac * 0.5f;
  } else if (!(t > 0)) {
    center = a + ab * 0.5f;
  } else if (!(s + t < d)) {
    center = b + (c - b) * 0.5f;
  } else {
    center = a + ab * (s / d) + ac * (t / d);
  }
  const float r2 = max_component(
      {dot(a - center, a - center), dot(b - center, b - center), dot(c - center, c - center)});
  return {center, radius_grown(std::sqrt(r2))};
}

/// The minimum enclosing sphere of two spheres, one of which may be empty.
RAYSHEAF_HD inline Sphere sphere_union(Sphere a, Sphere b) {
  if (a.radius < 0) return b;
  if (b.radius < 0) return a;
  const Vec3 d = b.center - a.center;
  const float distance = length(d);
  if (b.radius >= radius_grown(distance + a.radius)) return b;
  if (a.radius >= radius_grown(distance + b.radius)) return a;
  const float radius = (distance + a.radius + b.radius) * 0.5f;
  // If one sphere almost contains the other, the centre must not pass the larger sphere's centre.
  const float along = distance > 0 ? clamp((radius - a.radius) / distance, 0, 1) : 0;
  const Vec3 center = a.center + d * along;
  const float to_a = length(a.center - center) + a.radius;
  const float to_b = length(b.center - center) + b.radius;
  return {center, radius_grown(to_a > to_b ? to_a : to_b)};
}

}  // namespace raysheaf
