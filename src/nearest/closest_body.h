// The answer of a point query: the triangle that it has found, and where its nearest point is.
#pragma once

#include "nearest/exact_sign_body.h"
#include "nearest/point_triangle_body.h"
#include "raysheaf/points.h"

namespace raysheaf {

/// `prim_id` is the triangle's number; the other ids are not set.
RAYSHEAF_HD inline ClosestPoint closest_point_on(Point p, std::uint32_t triangle, Vec3 corner_a,
                                                 Vec3 corner_b, Vec3 corner_c) {
  const Point a = to_point(corner_a), b = to_point(corner_b), c = to_point(corner_c);
  const TriangleDistance found = distance_to_triangle(p, a, b, c);
  const Point at = point_of_weights(found.u, found.v, a, b, c);
  ClosestPoint one;
  one.distance = std::sqrt(found.squared);
  one.point = {at.x, at.y, at.z};
  one.u = found.u;
  one.v = found.v;
  one.prim_id = triangle;
  one.side = side_of_plane(p, a, b, c);
  return one;
}

}  // namespace raysheaf
