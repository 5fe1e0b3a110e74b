// Transforms in double precision: chains of nodes are long, and only the final transform is
// rounded.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "raysheaf/rig.h"

namespace raysheaf {

struct Double3 {
  double x = 0, y = 0, z = 0;
};
inline Double3 operator+(Double3 a, Double3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Double3 operator-(Double3 a, Double3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Double3 operator*(Double3 a, double s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline double dot(Double3 a, Double3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Double3 cross(Double3 a, Double3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// A unit vector along `a`, or `fallback` if `a` has no direction.
inline Double3 normalized(Double3 a, Double3 fallback) {
  const double n = std::sqrt(dot(a, a));
  return n > 0 && std::isfinite(n) ? a * (1 / n) : fallback;
}
inline Vec3 rounded(Double3 a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

/// An affine map: the images of the axes and of the origin.
struct Placement {
  std::array<Double3, 4> columns = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};
};

inline Double3 transform_vector(const Placement& a, Double3 v) {
  return a.columns[0] * v.x + a.columns[1] * v.y + a.columns[2] * v.z;
}
inline Placement compose(const Placement& outer, const Placement& inner) {
  Placement result;
  for (std::size_t c = 0; c < 3; ++c) result.columns[c] = transform_vector(outer, inner.columns[c]);
  result.columns[3] = transform_vector(outer, inner.columns[3]) + outer.columns[3];
  return result;
}
inline Affine rounded(const Placement& a) {
  Affine result;
  for (std::size_t c = 0; c < 4; ++c) {
    const Vec3 column = rounded(a.columns[c]);
    result.m[0][c] = column.x, result.m[1][c] = column.y, result.m[2][c] = column.z;
  }
  return result;
}
inline Placement widened(const Affine& a) {
  Placement result;
  for (std::size_t c = 0; c < 4; ++c) result.columns[c] = {a.m[0][c], a.m[1][c], a.m[2][c]};
  return result;
}

/// A node's transform relative to its parent.
[[nodiscard]] Placement local_placement(const RigNode& node);

/// Attributes of objects with a transform: a camera's frame without scale, right-handed and
/// orthonormal, whose -z axis is along the transform's -z; the direction of a light; and the axis
/// of a rectangle's width.
[[nodiscard]] Affine camera_frame(const Placement& to_world);
[[nodiscard]] Vec3 light_direction(const Placement& to_world);
[[nodiscard]] Vec3 light_right(const Placement& to_world);

}  // namespace raysheaf
