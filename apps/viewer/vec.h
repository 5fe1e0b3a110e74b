// The vector arithmetic of the camera.
#pragma once

#include <algorithm>
#include <cmath>

#include "raysheaf/types.h"

namespace raysheaf::viewer {

inline constexpr float kPi = 3.14159265f;

inline Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator*(Vec3 a, float s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline float dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(Vec3 a) {
  return std::sqrt(dot(a, a));
}
inline Vec3 normalized(Vec3 a) {
  const float l = length(a);
  return l > 0 ? a * (1 / l) : Vec3{0, 0, 1};
}
inline Vec3 mix(Vec3 a, Vec3 b, float t) {
  return a * (1 - t) + b * t;
}
inline bool is_finite(Vec3 a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
inline Vec3 column(const Affine& a, std::size_t c) {
  return {a.m[0][c], a.m[1][c], a.m[2][c]};
}
inline void set_column(Affine& a, std::size_t c, Vec3 v) {
  a.m[0][c] = v.x;
  a.m[1][c] = v.y;
  a.m[2][c] = v.z;
}

}  // namespace raysheaf::viewer
