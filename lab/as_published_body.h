// The computations in which the published program (Reis, Costa, Pereira 2017) differs from
// raysheaf, all in this file: its hash, equations 1-9, its spheres. Its bounds are not
// conservative: never compute hits with them.
#pragma once

#include <cmath>
#include <numbers>

#include "base/trigonometry.h"
#include "base/vec.h"
#include "geom/sphere.h"
#include "raysheaf/lab.h"

namespace raysheaf::as_published {

inline constexpr float kHalfPi = std::numbers::pi_v<float> / 2;
using ConeTest = Quirks::ConeTest;

/// The device's conversion to unsigned turns negative numbers and NaN into 0.
inline std::uint32_t field(float value, std::uint32_t most) {
  if (!(value > 0)) return 0;
  return value < static_cast<float>(most) ? static_cast<std::uint32_t>(value) : most;
}

/// In binary64, rounded: those of binary32 differ from processor to processor.
inline float azimuth(Vec3 v, bool as_coded) {
  return static_cast<float>(std::atan2(double{as_coded ? v.x : v.y}, double{v.x})) + kHalfPi;
}

inline float polar(float cosine) {
  return static_cast<float>(std::acos(double{clamp(cosine, -1, 1)}));
}

/// 2 bits of the light at bit 30, azimuth at bit 15, polar angle at bit 0.
inline std::uint32_t shadow_hash(std::uint32_t light, Vec3 d, bool as_coded) {
  std::uint32_t key = (light + 1) << 30;
  key += field(azimuth(d, as_coded) * 5, 31) << 15;
  key += field(polar(d.z) * 5, 31);
  return key + 1;
}

/// The direction from the world's origin to the ray's origin, then the ray's direction. The ranges
/// are larger than their fields.
inline std::uint32_t reflection_hash(Vec3 o, Vec3 d, bool as_coded) {
  const float distance = length(o);
  std::uint32_t key = field(azimuth(o, as_coded) * 20, 128);
  key = (key << 7) | field(polar(distance > 0 ? o.z / distance : 1) * 20, 128);
  key = (key << 7) | field(azimuth(d, as_coded) * 5, 30);
  key = (key << 5) | field(polar(d.z) * 5, 30);
  return key + 1;
}

struct Node {
  Vec3 center;
  float radius = 0;
  Vec3 axis;
  float spread = 0;  ///< half angle, from 0 to pi / 2
};

/// Equations 7 and 8, unless one sphere contains the other.
inline void merge_sphere(Node& node, Vec3 center, float radius) {
  const float between = length(center - node.center);
  if (between + radius <= node.radius) return;
  if (between + node.radius <= radius) {
    node.center = center;
    node.radius = radius;
    return;
  }
  node.center = (node.center + center) * 0.5f;
  node.radius = between * 0.5f + std::fmax(node.radius, radius);
}

/// Equations 1 to 4: extends a cone by a direction.
inline void extend_cone(Node& node, Vec3 r) {
  const float c = dot(node.axis, r);
  if (c >= std::cos(node.spread)) return;
  const Vec3 q = normalized(node.axis * c - r, node.axis);
  const Vec3 e = node.axis * std::cos(node.spread) + q * std::sin(node.spread);
  node.axis = normalized(e + r, node.axis);
  node.spread = std::fmin(polar(dot(node.axis, r)), kHalfPi);
}

/// Equations 5 and 6, with the angle taken as half of that between the axes plus the larger spread.
inline void merge_cone(Node& node, const Node& other) {
  const float between = polar(dot(node.axis, other.axis));
  const float spread = between * 0.5f + std::fmax(node.spread, other.spread);
  node.axis = normalized(node.axis + other.axis, node.axis);
  node.spread = std::fmin(spread, kHalfPi);
}

/// The factor that should tell whether the circumcentre lies beyond AC is always 0, so the sphere
/// over AC is used; if the squared area is below an eighth of a hundredth, that over the longest
/// edge.
inline Sphere undersized_sphere(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 ab = b - a, ac = c - a, bc = c - b;
  const float ab2 = dot(ab, ab), ac2 = dot(ac, ac), bc2 = dot(bc, bc), abac = dot(ab, ac);
  const float d = 2 * (ab2 * ac2 - abac * abac);
  if (d > 0.01f || (ac2 >= ab2 && ac2 >= bc2)) return {(a + c) * 0.5f, std::sqrt(ac2) * 0.5f};
  if (ab2 >= bc2) return {(a + b) * 0.5f, std::sqrt(ab2) * 0.5f};
  return {(b + c) * 0.5f, std::sqrt(bc2) * 0.5f};
}

/// The centre is moved only by the translation, and the radius is scaled by the largest diagonal
/// entry.
inline Sphere unrotated(const Sphere& object, const Affine& map) {
  const float scale =
      max_component({std::fabs(map.m[0][0]), std::fabs(map.m[1][1]), std::fabs(map.m[2][2])});
  return {object.center + column(map, 3), object.radius * scale};
}

/// A node prepared for many spheres.
struct ReadyNode {
  Vec3 center, axis;
  float radius, sin, cos, tan, secant;
  bool all;

  explicit ReadyNode(const Node& n)
      : center(n.center),
        axis(n.axis),
        radius(n.radius),
        sin(std::sin(n.spread)),
        cos(std::cos(n.spread)),
        tan(static_cast<float>(portable::tangent(n.spread))),
        secant(1 / std::cos(n.spread)),
        all(n.spread >= kHalfPi) {}
};

/// `along`: position of the sphere's centre along the axis; `aside2`: its squared distance from the
/// axis.
template <ConeTest kTest>
bool meets(const ReadyNode& node, float along, float aside2, float reach) {
  if constexpr (kTest == ConeTest::kExact) {
    const float aside = std::sqrt(aside2);
    const float from_line = aside * node.cos - along * node.sin;
    const float on_line = std::fmax(along * node.cos + aside * node.sin, 0.0f);
    const float beyond = along * node.cos + aside * node.sin - on_line;
    const bool inside = from_line <= 0 && along >= 0;
    return inside | (from_line * from_line + beyond * beyond <= reach * reach);
  } else {
    const float a = kTest == ConeTest::kUnsigned ? std::fabs(along) : along;
    const float line = a * node.tan + reach * node.secant;
    return (line >= 0) & (aside2 <= line * line);
  }
}

}  // namespace raysheaf::as_published
