// The arithmetic of a point on a triangle.
#pragma once

#include <cmath>

#include "base/float.h"
#include "base/vec.h"

namespace raysheaf {

/// Corners mixed with weights (1 - u - v, u, v).
struct MixedPoint {
  Vec3 position;
  float error = 0;  ///< bounds what rounding moved any coordinate by
};

/// The first weight is rounded twice: by at most eps (1 - u) and eps w, which moves the point by no
/// more than eps (1 + w) |a|. Each product then passes one rounding and at most two sums: gamma(3)
/// of the sum S of |w a|, |u b| and |v c|. Together at most gamma(4) S + gamma(1) |a|; a unit more
/// of each covers the rounding of the bound itself, and 2^-147 products that underflow (J. Arvo's
/// analysis, as in Pharr, Jakob and Humphreys, Physically Based Rendering, 2023, section 6.8.5).
RAYSHEAF_HD inline MixedPoint mixed_point(Vec3 a, Vec3 b, Vec3 c, float u, float v) {
  const float w = 1 - u - v;
  const Vec3 from_a = a * w, from_b = b * u, from_c = c * v;
  const Vec3 sum = abs(from_a) + abs(from_b) + abs(from_c);
  const Vec3 error = sum * gamma(5) + abs(a) * gamma(2);
  return {from_a + from_b + from_c, max_component(error) + 0x1p-147f};
}

/// A vector in double, for products that overflow or vanish in float.
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

/// A unit vector along `a`, or `fallback` where `a` has no direction.
RAYSHEAF_HD inline Vec3 unit(Wide a, Vec3 fallback) {
  const double size = std::sqrt(dot(a, a));
  if (!(size > 0 && std::isfinite(size))) return fallback;
  return {static_cast<float>(a.x / size), static_cast<float>(a.y / size),
          static_cast<float>(a.z / size)};
}

/// Where a map takes the normals of surfaces: its cofactors, and the side that they end up on.
struct NormalMap {
  Wide yz, zx, xy;
  double side = 1;
};
RAYSHEAF_HD inline NormalMap normal_map(const Affine& map) {
  const Wide x = widened(column(map, 0)), y = widened(column(map, 1)), z = widened(column(map, 2));
  const Wide yz = cross(y, z);
  return {yz, cross(z, x), cross(x, y), dot(x, yz) < 0 ? -1.0 : 1.0};
}

/// The image of a normal as a unit vector: `transform_normal` (base/vec.h) for maps of any scale.
RAYSHEAF_HD inline Vec3 unit_normal(const NormalMap& map, Vec3 normal, Vec3 fallback) {
  const Wide &yz = map.yz, &zx = map.zx, &xy = map.xy;
  const double nx = map.side * normal.x, ny = map.side * normal.y, nz = map.side * normal.z;
  return unit({yz.x * nx + zx.x * ny + xy.x * nz, yz.y * nx + zx.y * ny + xy.y * nz,
               yz.z * nx + zx.z * ny + xy.z * nz},
              fallback);
}

}  // namespace raysheaf
