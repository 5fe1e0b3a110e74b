// Does the volume swept by a bundle's rays, up to a reach T from their origins, intersect a sphere?
//
// As in cone_sphere_body.h, with the cone cut off by the sphere of radius T around its apex:
//
//        b |       .  P         s, e: P across and along the generator
//          |    .  g            hit  <=>  |v| <= R                           near the apex
//          | .    ) T                or   s <= R, e >= 0 and
//          +------)-----> a               ( e <= T                           next to the generator
//                                           or |P - T g| <= R                around its tip
//                                           or s <= 0 and |v| <= T + R )     before the cap
//
// Rounding. s and e have errors below gamma(20)|v|, like the sine and its derived values; e - T
// matters if T < e <= |v|, where its error is below gamma(22)|v|. A hit has a point of its ray, at
// a parameter in [0, t_max], within sqrt(3) gamma(2) of the farthest corner from the triangle
// (geom/ray_end.h), and that corner is at most |v| + R away. gamma(26)(|v| + R) covers both; the
// slack is 96 u.
#pragma once

#include "paper/bounds/finite_cone.h"
#include "paper/ray_hierarchy/cone_sphere_body.h"

namespace raysheaf {

inline constexpr float kFiniteConeSlack = 96 * kUnitRoundoff;

struct FiniteConeTest {
  ConeSphereTest cone;
  float cos_angle;
  float reach;
};

RAYSHEAF_HD inline FiniteConeTest make_node_test(const FiniteCone& bound) {
  return {make_cone_sphere_test(bound.rays), cosine_of_sine(bound.rays.directions.sin_angle),
          bound.reach};
}

RAYSHEAF_HD inline bool meets(const FiniteConeTest& node, Vec3 center, float radius) {
  const ConeSphereTest& cone = node.cone;
  const Vec3 v = center - cone.center;
  const Vec3 across = cross(v, cone.axis);
  const float a = dot(v, cone.axis), b2 = dot(across, across), v2 = dot(v, v);
  const float sum = cone.radius + radius;
  const float size = (std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z)) + sum;
  const float reach = sum + (kFiniteConeSlack * size + kConeSphereTiny);
  const float far = node.reach + reach;
  const bool huge = !(v2 < kConeSphereHuge);
  const bool before_cap = far >= 0 && v2 <= far * far;
  if (cone.whole) return before_cap || huge;
  const float b = std::sqrt(b2);
  const float s = b * node.cos_angle - a * cone.sin_angle;
  const float e = a * node.cos_angle + b * cone.sin_angle;
  const float over = e - node.reach;
  const bool beside = s <= reach && e >= 0;
  const bool tip = s * s + over * over <= reach * reach;
  const bool ends = over <= 0 || tip || (s <= 0 && before_cap);
  return (reach >= 0 && v2 <= reach * reach) || (reach >= 0 && beside && ends) || huge;
}

}  // namespace raysheaf
