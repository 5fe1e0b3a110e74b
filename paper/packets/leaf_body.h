// Computations of a packet with one node's boxes, and with one triangle and one ray in its leaves.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/bits.h"
#include "intersect/triangle_body.h"
#include "object_tree/bvh_node.h"
#include "paper/packets/frustum_body.h"

namespace raysheaf {

/// Number of triangles that are tested with all rays of a packet at once.
inline constexpr std::uint32_t kPacketChunk = 64;

/// A child of a node that is a leaf.
RAYSHEAF_HD inline std::uint32_t leaf_ref(std::uint32_t node, std::uint32_t child) {
  return node * kBvhWidth + child;
}

/// The children of a node that a packet intersects, one bit each.
struct Met {
  std::uint8_t nodes = 0, leaves = 0;
};

RAYSHEAF_HD inline Met meet_children(const PacketFrustum& frustum, const BvhNode& node) {
  Met met;
  for (std::uint32_t c = 0; c < node.children; ++c) {
    const Box box = node.box(c);
    if (!meets(frustum, box.min, box.max)) continue;
    std::uint8_t& bits = node.is_leaf(c) ? met.leaves : met.nodes;
    bits = static_cast<std::uint8_t>(bits | (1u << c));
  }
  return met;
}

RAYSHEAF_HD inline std::uint32_t ones(std::uint8_t bits) {
  std::uint32_t count = 0;
  for (std::uint32_t rest = bits; rest != 0; rest &= rest - 1) ++count;
  return count;
}

/// -1 if the packet's rays, of which `direction` is one, point down its axis, else 1.
RAYSHEAF_HD inline float packet_sign(const PacketFrustum& frustum, Vec3 direction) {
  return component(direction, frustum.axis) < 0 ? -1.0f : 1.0f;
}

/// An integer that increases with `x`.
RAYSHEAF_HD inline std::uint32_t ordered_bits(float x) {
  const std::uint32_t bits = float_bits(x);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

/// Where a triangle begins along the packet's axis, as an integer in the same order.
RAYSHEAF_HD inline std::uint32_t triangle_begin(const PacketFrustum& f, float sign, Vec3 a, Vec3 b,
                                                Vec3 c) {
  const Vec3 begin = sign < 0 ? max(max(a, b), c) : min(min(a, b), c);
  return ordered_bits(sign * component(begin - f.origin, f.axis));
}

/// The range of the triangles' depths from the frustum's origin.
struct Depths {
  float begin = std::numeric_limits<float>::infinity();
  float end = -std::numeric_limits<float>::infinity();

  RAYSHEAF_HD void enlarge(float depth) {
    begin = std::fmin(begin, depth);
    end = std::fmax(end, depth);
  }
};

/// A lower bound of t of any hit of the ray with triangles between two depths.
///
/// A hit is a point of a triangle, so its t is at least the minimum of the corners' scaled depths,
/// except for one rounding of it and gamma(5) in this computation. gamma(64) is larger than both.
RAYSHEAF_HD inline float least_t(const RaySetup& ray, float ray_depth, Depths depths) {
  const float size =
      std::fmax(std::fabs(depths.begin), std::fabs(depths.end)) + std::fabs(ray_depth);
  return ((depths.begin - ray_depth) - gamma(64) * size) * std::fabs(ray.shear_z);
}

}  // namespace raysheaf
