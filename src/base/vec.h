// Mathematics on the vectors and affine maps of the public interface.
//
// Nothing here is contracted into fused multiply-adds: the project is compiled with contraction
// off, so that every expression has the same bits on every device (docs/decisions/0001).
#pragma once

#include <cmath>

#include "base/host_device.h"
#include "base/mirrors_body.h"
#include "raysheaf/types.h"

namespace raysheaf {

RAYSHEAF_HD inline Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
RAYSHEAF_HD inline Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
RAYSHEAF_HD inline Vec3 operator*(Vec3 a, Vec3 b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
RAYSHEAF_HD inline Vec3 operator*(Vec3 a, float s) {
  return {a.x * s, a.y * s, a.z * s};
}
RAYSHEAF_HD inline Vec3 operator*(float s, Vec3 a) {
  return a * s;
}
RAYSHEAF_HD inline Vec3 operator/(Vec3 a, float s) {
  return {a.x / s, a.y / s, a.z / s};
}
RAYSHEAF_HD inline Vec3 operator-(Vec3 a) {
  return {-a.x, -a.y, -a.z};
}
RAYSHEAF_HD inline Vec3& operator+=(Vec3& a, Vec3 b) {
  return a = a + b;
}
RAYSHEAF_HD inline Vec3& operator*=(Vec3& a, float s) {
  return a = a * s;
}
RAYSHEAF_HD inline bool operator==(Vec3 a, Vec3 b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

RAYSHEAF_HD inline Vec2 operator+(Vec2 a, Vec2 b) {
  return {a.x + b.x, a.y + b.y};
}
RAYSHEAF_HD inline Vec2 operator*(Vec2 a, float s) {
  return {a.x * s, a.y * s};
}

RAYSHEAF_HD inline float dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
RAYSHEAF_HD inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
RAYSHEAF_HD inline float length(Vec3 a) {
  return std::sqrt(dot(a, a));
}
/// A unit vector along `a`, or `fallback` if `a` has no direction. Works for every length: it
/// avoids squares outside the range of a float.
RAYSHEAF_HD inline Vec3 normalized(Vec3 a, Vec3 fallback = {0, 0, 1}) {
  const float n = length(a);
  if (n > 1e-15f && n < 1e15f) return a / n;
  const float largest = std::fmax(std::fabs(a.x), std::fmax(std::fabs(a.y), std::fabs(a.z)));
  if (!(largest > 0 && largest < std::numeric_limits<float>::infinity())) return fallback;
  const Vec3 scaled = a / largest;
  return scaled / length(scaled);
}
RAYSHEAF_HD inline Vec3 lerp(Vec3 a, Vec3 b, float t) {
  return a * (1 - t) + b * t;
}
RAYSHEAF_HD inline Vec3 abs(Vec3 a) {
  return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)};
}
RAYSHEAF_HD inline Vec3 min(Vec3 a, Vec3 b) {
  return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}
RAYSHEAF_HD inline Vec3 max(Vec3 a, Vec3 b) {
  return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}
RAYSHEAF_HD inline float min_component(Vec3 a) {
  const float m = a.x < a.y ? a.x : a.y;
  return m < a.z ? m : a.z;
}
RAYSHEAF_HD inline float max_component(Vec3 a) {
  const float m = a.x > a.y ? a.x : a.y;
  return m > a.z ? m : a.z;
}
RAYSHEAF_HD inline float component(Vec3 a, int axis) {
  return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}
RAYSHEAF_HD inline float clamp(float x, float lo, float hi) {
  return x < lo ? lo : (x > hi ? hi : x);
}
RAYSHEAF_HD inline float luminance(Vec3 c) {
  return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}
RAYSHEAF_HD inline bool is_finite(Vec3 a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// The image of a point; of a direction (no translation); of a normal (inverse transpose, up to
/// scale).
RAYSHEAF_HD inline Vec3 transform_vector(const Affine& a, Vec3 v) {
  return {a.m[0][0] * v.x + a.m[0][1] * v.y + a.m[0][2] * v.z,
          a.m[1][0] * v.x + a.m[1][1] * v.y + a.m[1][2] * v.z,
          a.m[2][0] * v.x + a.m[2][1] * v.y + a.m[2][2] * v.z};
}
RAYSHEAF_HD inline Vec3 transform_point(const Affine& a, Vec3 p) {
  return {a.m[0][0] * p.x + a.m[0][1] * p.y + a.m[0][2] * p.z + a.m[0][3],
          a.m[1][0] * p.x + a.m[1][1] * p.y + a.m[1][2] * p.z + a.m[1][3],
          a.m[2][0] * p.x + a.m[2][1] * p.y + a.m[2][2] * p.z + a.m[2][3]};
}
RAYSHEAF_HD inline Vec3 column(const Affine& a, int c) {
  return {a.m[0][c], a.m[1][c], a.m[2][c]};
}
/// Transforms normals by the cofactor matrix, which is the inverse transpose times the determinant:
/// this needs no division and also works for singular maps. The sign accounts for maps that mirror.
RAYSHEAF_HD inline Vec3 transform_normal(const Affine& a, Vec3 n) {
  const Vec3 x = column(a, 0), y = column(a, 1), z = column(a, 2);
  const Vec3 image = cross(y, z) * n.x + cross(z, x) * n.y + cross(x, y) * n.z;
  return mirrors(a) ? -image : image;
}
RAYSHEAF_HD inline Affine compose(const Affine& outer, const Affine& inner) {
  Affine result;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) {
      result.m[r][c] = outer.m[r][0] * inner.m[0][c] + outer.m[r][1] * inner.m[1][c] +
                       outer.m[r][2] * inner.m[2][c] + (c == 3 ? outer.m[r][3] : 0.0f);
    }
  }
  return result;
}
inline Affine translation(Vec3 t) {
  Affine a;
  a.m[0][3] = t.x, a.m[1][3] = t.y, a.m[2][3] = t.z;
  return a;
}
inline Affine scaling(Vec3 s) {
  Affine a;
  a.m[0][0] = s.x, a.m[1][1] = s.y, a.m[2][2] = s.z;
  return a;
}
/// Rotation about a unit axis, counter-clockwise for a viewer who looks against the axis (Rodrigues
/// 1840).
inline Affine rotation(Vec3 axis, float radians) {
  const float c = std::cos(radians), s = std::sin(radians), k = 1 - c;
  Affine a;
  a.m[0] = {c + axis.x * axis.x * k, axis.x * axis.y * k - axis.z * s,
            axis.x * axis.z * k + axis.y * s, 0};
  a.m[1] = {axis.y * axis.x * k + axis.z * s, c + axis.y * axis.y * k,
            axis.y * axis.z * k - axis.x * s, 0};
  a.m[2] = {axis.z * axis.x * k - axis.y * s, axis.z * axis.y * k + axis.x * s,
            c + axis.z * axis.z * k, 0};
  return a;
}
/// A camera frame: its -z axis points from `eye` to `target`, and +y is as close to `up` as
/// possible.
inline Affine look_at(Vec3 eye, Vec3 target, Vec3 up) {
  const Vec3 z = normalized(eye - target);
  const Vec3 x = normalized(cross(up, z), {1, 0, 0});
  const Vec3 y = cross(z, x);
  Affine a;
  a.m[0] = {x.x, y.x, z.x, eye.x};
  a.m[1] = {x.y, y.y, z.y, eye.y};
  a.m[2] = {x.z, y.z, z.z, eye.z};
  return a;
}

}  // namespace raysheaf
