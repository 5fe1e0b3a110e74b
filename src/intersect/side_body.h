// Which side of a triangle's plane a direction comes from.
#pragma once

#include "intersect/triangle_body.h"

namespace raysheaf {

/// Whether it comes from the side where the corners run counter-clockwise: `TriangleHit::front` of
/// any ray along `direction` that meets the triangle, exactly.
inline bool comes_from_front(Vec3 direction, Vec3 a, Vec3 b, Vec3 c) {
  // A ray from a corner meets the triangle there, and its determinant is that of any other ray.
  const Determinants x = determinants(a, direction, a, b, c);
  if (std::fabs(x.det) > x.det_error) return x.det < 0;
  return answer_in_integers(a, direction, a, b, c).front;
}

}  // namespace raysheaf
