// Arithmetic for points on triangles.
#pragma once

#include <cmath>

#include "base/float.h"
#include "base/mirrors_body.h"
#include "base/vec.h"

namespace raysheaf {

/// A vector in double, for products that overflow or underflow in float.
struct Wide {
  double x = 0, y = 0, z = 0;
};
RAYSHEAF_HD inline Wide widened(Vec3 a) {
  return {a.x, a.y, a.z};
}
RAYSHEAF_HD inline Wide difference(Vec3 a, Vec3 b) {
  return {static_cast<double>(a.x) - b.x, static_cast<double>(a.y) - b.y,
          static_cast<double>(a.z) - b.z};
}
RAYSHEAF_HD inline Wide cross(Wide a, Wide b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
RAYSHEAF_HD inline double dot(Wide a, Wide b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Corners interpolated with weights (1 - u - v, u, v), in binary64: each coordinate has an error
/// of one rounding to binary32.
struct MixedPoint {
  Vec3 position;
  float reach = 0;  ///< the largest difference of a coordinate from a corner's
};
RAYSHEAF_HD inline MixedPoint mixed_point(Vec3 a, Vec3 b, Vec3 c, float u, float v) {
  const double w = 1.0 - u - v;
  const auto mix = [&](float x, float y, float z) {
    return static_cast<float>(x * w + static_cast<double>(y) * u + static_cast<double>(z) * v);
  };
  const Vec3 p{mix(a.x, b.x, c.x), mix(a.y, b.y, c.y), mix(a.z, b.z, c.z)};
  return {p, max_component(max(abs(a - p), max(abs(b - p), abs(c - p))))};
}

/// The minimum distance along its triangle's normal at which a ray that leaves a point must start,
/// so that it hits neither that triangle nor a coplanar neighbour of similar size. The point's
/// coordinates and those of the start have a rounding error each, of which the component along the
/// normal matters. The intersection test is exact: the part from `reach` covers the rounding of the
/// normal and of the neighbour's corners.
inline constexpr float kClearOfReach = 1;
RAYSHEAF_HD inline float clearance(const MixedPoint& point, Vec3 normal) {
  const Vec3 n = abs(normal), p = abs(point.position);
  const float off = n.x * p.x + n.y * p.y + n.z * p.z;
  return (2 * off + kClearOfReach * point.reach) * kUnitRoundoff + 0x1p-147f;
}

/// A unit vector along `a`, or `fallback` if `a` has no direction.
RAYSHEAF_HD inline Vec3 unit(Wide a, Vec3 fallback) {
  const double size = std::sqrt(dot(a, a));
  if (!(size > 0 && std::isfinite(size))) return fallback;
  return {static_cast<float>(a.x / size), static_cast<float>(a.y / size),
          static_cast<float>(a.z / size)};
}

/// How a map transforms normals: its cofactors, and the sign of its determinant.
struct NormalMap {
  Wide yz, zx, xy;
  double side = 1;
};
RAYSHEAF_HD inline NormalMap normal_map(const Affine& map) {
  const Wide x = widened(column(map, 0)), y = widened(column(map, 1)), z = widened(column(map, 2));
  return {cross(y, z), cross(z, x), cross(x, y), mirrors(map) ? -1.0 : 1.0};
}

/// The corners' values, interpolated at a point.
template <class T>
RAYSHEAF_HD T mixed(const T (&of_corner)[3], float u, float v) {
  return of_corner[0] * (1 - u - v) + of_corner[1] * u + of_corner[2] * v;
}

/// Unit normal of the front side, from which the corners are counter-clockwise; clockwise if the
/// instance mirrors. Zero if the triangle has no area.
RAYSHEAF_HD inline Vec3 front_normal(const Vec3 (&corner)[3], bool mirrored) {
  const Wide along = cross(difference(corner[1], corner[0]), difference(corner[2], corner[0]));
  const Vec3 normal = unit(along, {0, 0, 0});
  return mirrored ? -normal : normal;
}

/// The image of a normal as a unit vector: `transform_normal` (base/vec.h) for maps of any scale.
RAYSHEAF_HD inline Vec3 unit_normal(const NormalMap& map, Vec3 normal, Vec3 fallback) {
  const Wide &yz = map.yz, &zx = map.zx, &xy = map.xy;
  const double nx = map.side * normal.x, ny = map.side * normal.y, nz = map.side * normal.z;
  return unit({yz.x * nx + zx.x * ny + xy.x * nz, yz.y * nx + zx.y * ny + xy.y * nz,
               yz.z * nx + zx.z * ny + xy.z * nz},
              fallback);
}

/// Replaces a front normal by `bump`, given in the frame of the triangle's texture coordinates:
/// along u, against v, along the normal. The frame is orthogonal: its first axis is the component
/// of u's direction perpendicular to the normal. Returns the normal unchanged if there is no such
/// frame.
RAYSHEAF_HD inline Vec3 bumped_normal(const Vec3 (&corner)[3], const Vec2 (&uv)[3], Vec3 normal,
                                      Vec3 bump) {
  const Wide n = widened(normal);
  const Wide e1 = difference(corner[1], corner[0]), e2 = difference(corner[2], corner[0]);
  const double u1 = static_cast<double>(uv[1].x) - uv[0].x;
  const double v1 = static_cast<double>(uv[1].y) - uv[0].y;
  const double u2 = static_cast<double>(uv[2].x) - uv[0].x;
  const double v2 = static_cast<double>(uv[2].y) - uv[0].y;
  const double side = u1 * v2 - u2 * v1;
  if (!(side < 0 || side > 0)) return normal;
  const double sign = side < 0 ? -1 : 1;
  const Wide along_u{(e1.x * v2 - e2.x * v1) * sign, (e1.y * v2 - e2.y * v1) * sign,
                     (e1.z * v2 - e2.z * v1) * sign};
  const Wide along_v{(e2.x * u1 - e1.x * u2) * sign, (e2.y * u1 - e1.y * u2) * sign,
                     (e2.z * u1 - e1.z * u2) * sign};
  const double lean = dot(along_u, n);
  const Vec3 tangent =
      unit({along_u.x - n.x * lean, along_u.y - n.y * lean, along_u.z - n.z * lean}, {0, 0, 0});
  if (tangent == Vec3{0, 0, 0}) return normal;
  const Wide t = widened(tangent), across = cross(n, t);
  const double up = dot(across, along_v) > 0 ? -1 : 1;
  const double x = bump.x, y = up * bump.y, z = bump.z;
  return unit({t.x * x + across.x * y + n.x * z, t.y * x + across.y * y + n.y * z,
               t.z * x + across.z * y + n.z * z},
              normal);
}

/// Flips a shading normal to the side of a geometric one. Normals from a file may oppose the
/// winding of their triangle; without this, every ray would seem to come from behind the surface.
RAYSHEAF_HD inline Vec3 on_side_of(Vec3 geometric, Vec3 shading) {
  return dot(widened(shading), widened(geometric)) < 0 ? -shading : shading;
}

/// Position and normals of a surface, as in `Surface`.
struct PlacedSurface {
  Vec3 position, geometric_normal, normal;
  float clearance = 0;
  bool front = true;
};

/// At the weights `u`, `v` of corners 1 and 2, for a ray along `direction`. `front`: from
/// `front_normal`; `normals`: of the corners, in the instance's own space, or null.
RAYSHEAF_HD inline PlacedSurface placed_surface(const Vec3 (&corner)[3], Vec3 front,
                                                const Vec3 (*normals)[3], const NormalMap& map,
                                                float u, float v, Vec3 direction) {
  PlacedSurface placed;
  const MixedPoint point = mixed_point(corner[0], corner[1], corner[2], u, v);
  placed.position = point.position;
  const bool flat = front == Vec3{0, 0, 0};
  const Vec3 facing = flat ? unit(widened(-direction), {0, 0, 1}) : front;
  placed.clearance = raysheaf::clearance(point, facing);
  placed.front = !(dot(widened(facing), widened(direction)) > 0);
  const Vec3 shading = normals != nullptr
                           ? on_side_of(facing, unit_normal(map, mixed(*normals, u, v), facing))
                           : facing;
  placed.geometric_normal = placed.front ? facing : -facing;
  placed.normal = placed.front ? shading : -shading;
  return placed;
}

}  // namespace raysheaf
