// Processes one triangle of a block that streams past rays, on the CPU and on devices.
#pragma once

#include "geom/beam_box_body.h"
#include "geom/ray_end.h"
#include "geom/shaft.h"
#include "methods/dual/dual.h"
#include "raysheaf/stream.h"

namespace raysheaf {

/// Children per node of the tree over the rays.
inline constexpr std::uint32_t kRayBranching = 16;
/// The largest number of levels for rays with 32-bit numbers.
inline constexpr std::uint32_t kMostRayLevels = 8;
/// Bits of the rays' sort keys (rays/ray_place_body.h), per axis and in all.
inline constexpr std::uint32_t kRayKeyAxisBits = 9, kRayKeyBits = 5 * kRayKeyAxisBits;

/// The number of nodes of a level, from the number of nodes or rays below it.
RAYSHEAF_HD inline std::size_t nodes_above(std::size_t below) {
  return (below + kRayBranching - 1) / kRayBranching;
}

/// Whether a hit of `ray` with a triangle in `box` may be reported, according to geom/ray_end.h.
// The line's point at a hit's t lies in the box grown by the slack. The quotients and the
// differences before them are rounded: gamma(4) of the parameters, as in ray_end.h.
[[nodiscard]] RAYSHEAF_HD inline bool may_meet(const Ray& ray, const Box& box) {
  const Vec3 lo = box.min - ray.origin, hi = box.max - ray.origin;
  const float pad = kEndSlack * max_component(max(abs(lo), abs(hi))) + kTinySlack;
  float enter = ray.t_min, exit = ray.t_max;
  clip_to_slab(lo.x - pad, hi.x + pad, ray.direction.x, &enter, &exit);
  clip_to_slab(lo.y - pad, hi.y + pad, ray.direction.y, &enter, &exit);
  clip_to_slab(lo.z - pad, hi.z + pad, ray.direction.z, &enter, &exit);
  return enter * (1 - gamma(4)) <= exit * (1 + gamma(4));
}

/// The squared distance between the nearest points of two boxes; finite even for very distant
/// boxes.
RAYSHEAF_HD inline float squared_gap(const Box& a, const Box& b) {
  const Vec3 gap = max(max(a.min - b.max, b.min - a.max), {0, 0, 0});
  const float squared = dot(gap, gap);
  constexpr float kLargest = std::numeric_limits<float>::max();
  return squared < kLargest ? squared : kLargest;
}

/// Same as `precedes`.
RAYSHEAF_HD inline bool comes_before(const Hit& a, const Hit& b) {
  if (a.t != b.t) return a.t < b.t;
  if (a.geom_id != b.geom_id) return a.geom_id < b.geom_id;
  if (a.inst_id != b.inst_id) return a.inst_id < b.inst_id;
  return a.prim_id < b.prim_id;
}

/// A block, with pointers to its arrays.
struct BlockView {
  std::uint32_t number = 0;  ///< of the block
  View<const Vec3> positions;
  const std::uint32_t* corners = nullptr;  ///< three per triangle: indices into `positions`
  View<const std::uint32_t> prim_ids;
  View<const BlockPart> parts;

  [[nodiscard]] RAYSHEAF_HD std::uint32_t count() const {
    return static_cast<std::uint32_t>(prim_ids.size);
  }
};

/// The index of a triangle's part.
RAYSHEAF_HD inline std::uint32_t part_of_triangle(View<const BlockPart> parts,
                                                  std::uint32_t triangle) {
  std::uint32_t first = 0;
  for (auto count = static_cast<std::uint32_t>(parts.size); count > 1;) {
    const std::uint32_t half = count / 2;
    if (parts.data[first + half].first <= triangle) first += half;
    count -= half;
  }
  return first;
}

/// Converts a hit with a triangle of the block to the scene's ids.
RAYSHEAF_HD inline Hit hit_in_block(const BlockView& block, const IndexedHit& found) {
  const BlockPart& part = block.parts.data[part_of_triangle(block.parts, found.triangle)];
  return {found.t,      found.u,     found.v, block.prim_ids.data[found.triangle],
          part.geom_id, part.inst_id};
}

/// Replaces `best` by the block's hit if that comes before it; returns whether it did.
RAYSHEAF_HD inline bool take_least(const BlockView& block, const IndexedHit& found,
                                   StreamHit* best) {
  const Hit hit = hit_in_block(block, found);
  if (best->block != kInvalidId && !comes_before(hit, best->hit)) return false;
  best->hit = hit;
  best->block = block.number;
  best->part = part_of_triangle(block.parts, found.triangle);
  best->triangle = found.triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = block.corners[std::size_t{3} * found.triangle + k];
    best->vertex[k] = vertex;
    best->corner[k] = block.positions.data[vertex];
  }
  return true;
}

}  // namespace raysheaf
