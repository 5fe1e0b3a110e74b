// The node test of `rah` and `crsh`: does the volume swept by a bundle's rays intersect a sphere?
//
// With P, d the sphere, C, r the sphere of origins, x and alpha the cone, v = P - C and R = r + d,
// the sphere intersects the volume if the distance of v to the cone at the origin is at most R
// (Minkowski sum). With a = v.x and b = |v x x|, in the half plane (a, b):
//
//        b |     . P            s = b cos - a sin: distance to the generator's line
//          |   .   \ s          e = a cos + b sin: the foot's place along the generator
//          | .      \  generator
//          +-----------------> a (axis)
//
//   hit  <=>  |v| <= R   or   (s <= R and e >= 0)
//
// The second part by itself, without e >= 0, is equation 9 of Reis et al. 2017 with a signed: it
// uses the line instead of the generator and so accepts spheres behind the origins.
//
// Rounding. v has a relative error of u per component, a and b absolute errors below gamma(8)|v|,
// the sine was measured with an error below gamma(16). A ray's hit is a point of the triangle,
// whose t is rounded: a ray that ends there has its end within sqrt(3) gamma(2) |A| of the
// triangle, where |A| <= |v| + R is the farthest corner from an origin (geom/ray_end.h). Both sides
// of each comparison are therefore accurate to gamma(40)(|v| + R), by which R grows; |v| is bounded
// by the sum of its components. R also grows by 2^-60, so that its square does not underflow; if
// |v|^2 is not small compared with the largest float, the sphere is accepted.
#pragma once

#include <cmath>

#include "base/float.h"
#include "paper/bounds/ray_bound.h"

namespace raysheaf {

inline constexpr float kConeSphereSlack = 64 * kUnitRoundoff;
inline constexpr float kConeSphereTiny = 0x1p-60f;
inline constexpr float kConeSphereHuge = 0x1p120f;

/// A node prepared for many spheres.
struct ConeSphereTest {
  Vec3 center, axis;
  float radius;
  float sin_angle, sin2_angle, cos2_angle;
  bool whole;
};

RAYSHEAF_HD inline ConeSphereTest make_cone_sphere_test(const RayBound& bound) {
  const float s = bound.directions.sin_angle;
  return {bound.origins.center, bound.directions.axis,   bound.origins.radius, s, s * s,
          (1 - s) * (1 + s),    bound.directions.whole()};
}

RAYSHEAF_HD inline bool meets(const ConeSphereTest& node, Vec3 center, float radius) {
  if (node.whole) return true;
  const Vec3 v = center - node.center;
  const Vec3 across = cross(v, node.axis);
  const float a = dot(v, node.axis), b2 = dot(across, across), v2 = dot(v, v);
  const float sum = node.radius + radius;
  const float size = (std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z)) + sum;
  const float reach = sum + (kConeSphereSlack * size + kConeSphereTiny);
  const float line = reach + a * node.sin_angle;
  const bool beside = line >= 0 && b2 * node.cos2_angle <= line * line;
  const bool ahead = a >= 0 || b2 * node.sin2_angle >= (a * a) * node.cos2_angle;
  return v2 <= reach * reach || (beside && ahead) || !(v2 < kConeSphereHuge);
}

}  // namespace raysheaf
