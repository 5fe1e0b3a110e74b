// The computation for one triangle in world space.
#pragma once

#include <cmath>

#include "intersect/wide_body.h"
#include "scene/flat_scene.h"
#include "scene/mesh_bound_body.h"

namespace raysheaf {

/// Whether the area of a triangle with finite corners is exactly zero. Binary64 decides it unless
/// products are within four roundings of each other; integers decide the rest.
RAYSHEAF_HD inline bool has_no_area(Vec3 a, Vec3 b, Vec3 c) {
  const double ux = static_cast<double>(b.x) - a.x, vx = static_cast<double>(c.x) - a.x;
  const double uy = static_cast<double>(b.y) - a.y, vy = static_cast<double>(c.y) - a.y;
  const double uz = static_cast<double>(b.z) - a.z, vz = static_cast<double>(c.z) - a.z;
  const auto differ = [](double p, double q) {
    return std::fabs(p - q) > 0x1p-51 * (std::fabs(p) + std::fabs(q));
  };
  if (differ(uy * vz, uz * vy) || differ(uz * vx, ux * vz) || differ(ux * vy, uy * vx))
    return false;
  return are_in_line(a, b, c);
}

/// The triangle's sphere at any scale: `triangle_sphere` loses squares of lengths below 1e-19 and
/// fourth powers above 1e9. The centre is that of `triangle_sphere`, or the first corner if it has
/// none. The radius reaches every corner: it is measured in double, and that error of at most 2^-50
/// is added.
RAYSHEAF_HD inline Sphere conservative_triangle_sphere(Vec3 a, Vec3 b, Vec3 c) {
  Vec3 center = triangle_sphere(a, b, c).center;
  if (!is_finite(center)) center = a;
  const double to_a = squared_distance_in_double(a, center);
  const double to_b = squared_distance_in_double(b, center);
  const double to_c = squared_distance_in_double(c, center);
  const double to_ab = to_a > to_b ? to_a : to_b;
  return shape_sphere(center, to_ab > to_c ? to_ab : to_c);
}

/// Takes a triangle's corners to where an instance puts them; false where one lies farther out than
/// `kLargestCoordinate`, or nowhere.
RAYSHEAF_HD inline bool place_corners(const Affine& to_world, Vec3 (&corner)[3]) {
  for (Vec3& at : corner) {
    at = transform_point(to_world, at);
    if (!(max_component(abs(at)) <= kLargestCoordinate)) return false;
  }
  return true;
}

/// Makes a point of a triangle without area.
RAYSHEAF_HD inline void collapse_flat(Vec3 (&corner)[3]) {
  if (has_no_area(corner[0], corner[1], corner[2])) corner[1] = corner[2] = corner[0];
}

}  // namespace raysheaf
