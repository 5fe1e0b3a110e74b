// Which side of a triangle's plane a direction comes from.
#pragma once

#include <cmath>

#include "geom/surface_body.h"
#include "intersect/wide_body.h"

namespace raysheaf {

/// Whether it comes from the side where the corners run counter-clockwise: `TriangleHit::front` of
/// any ray along `direction` that meets the triangle, exactly.
inline bool comes_from_front(Vec3 direction, Vec3 a, Vec3 b, Vec3 c) {
  const Wide e = difference(b, a), f = difference(c, a), d = widened(direction);
  const auto size = [](double p, double q, double r, double s) {
    return std::fabs(p * q) + std::fabs(r * s);
  };
  const double det = dot(cross(e, f), d);
  const double error = 0x1p-50 * (size(e.y, f.z, e.z, f.y) * std::fabs(d.x) +
                                  size(e.z, f.x, e.x, f.z) * std::fabs(d.y) +
                                  size(e.x, f.y, e.y, f.x) * std::fabs(d.z));
  if (std::fabs(det) > error) return det < 0;
  // A ray from a corner meets the triangle there, and its determinant is that of any other ray.
  return answer_in_integers(a, direction, a, b, c).front;
}

}  // namespace raysheaf
