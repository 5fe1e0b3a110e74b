// Double-precision vectors and affine maps for the loaders.
#pragma once

#include <array>
#include <cmath>

#include "raysheaf/types.h"

namespace raysheaf::io {

/// `validate` refuses vertices with a larger coordinate.
inline constexpr float kFarthest = 1e18f;

struct Double3 {
  double x = 0, y = 0, z = 0;
};

inline Double3 widen(Vec3 a) {
  return {a.x, a.y, a.z};
}
inline bool is_finite(Vec3 a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
inline Vec3 narrow(Double3 a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}
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
inline double length(Double3 a) {
  return std::sqrt(dot(a, a));
}
/// A unit vector along `a`, or `fallback` if `a` has no direction.
inline Double3 normalized(Double3 a, Double3 fallback) {
  const double n = length(a);
  return n > 0 && std::isfinite(n) ? a * (1 / n) : fallback;
}

/// Normalises a direction from a file. A unit vector stays unchanged, so that a written file reads
/// back the same. False if `a` has no direction.
inline bool make_unit(Vec3& a) {
  const double squared = dot(widen(a), widen(a));
  if (!(squared > 0) || !std::isfinite(squared)) return false;
  if (std::fabs(squared - 1) > 1e-5) a = narrow(widen(a) * (1 / std::sqrt(squared)));
  return true;
}

/// An affine map: the images of the axes and of the origin.
struct DoubleAffine {
  std::array<Double3, 4> columns = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};
};

inline Affine narrow(const DoubleAffine& a) {
  Affine result;
  for (std::size_t c = 0; c < 4; ++c) {
    const Vec3 column = narrow(a.columns[c]);
    result.m[0][c] = column.x, result.m[1][c] = column.y, result.m[2][c] = column.z;
  }
  return result;
}
}  // namespace raysheaf::io
