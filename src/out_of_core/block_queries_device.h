// Loops for a batch of rays that stays on a device while blocks stream past it. For sources that
// include a device.
#pragma once

#include "device/walks_device.h"
#include "out_of_core/block_body.h"

namespace raysheaf {

/// The tree over the rays; [0] are the leaves.
struct RayLevels {
  const BeamTest* level[kMostRayLevels] = {};
  std::uint32_t size[kMostRayLevels] = {};
  std::uint32_t count = 0;
};

/// Rays in the order of the tree, with their current ends.
struct RayState {
  View<Ray> rays;
  std::uint32_t* numbers = nullptr;  ///< the caller's; kInvalidId: done
  RayLevels levels;
};

/// Boxes that are tested together are passed by value with the kernel.
inline constexpr std::uint32_t kMetWindow = 64;
struct BoxWindow {
  Box box[kMetWindow];
};
/// Counters that the host reads between two rounds.
struct BlockMail {
  std::uint64_t changed;  ///< rays that became shorter or were done since `begin`
  std::uint32_t met[kMetWindow];
};

/// Whether a node of a level and all its ancestors intersect the box.
RAYSHEAF_HD inline bool is_reached(const RayLevels& levels, std::uint32_t level, std::size_t node,
                                   const Box& box) {
  constexpr std::uint32_t kBits = 4;
  static_assert(1u << kBits == kRayBranching);
  for (std::uint32_t l = levels.count; l-- > level;)
    if (!meets(levels.level[l][node >> (kBits * (l - level))], box)) return false;
  return true;
}

/// Calls `leaf(number)` for the intersected leaves under a node of level 0 or 1, until it returns
/// false.
template <class Leaf>
RAYSHEAF_HD void for_leaves_met(const RayLevels& levels, std::uint32_t level, std::size_t node,
                                const Box& box, const Leaf& leaf) {
  if (!is_reached(levels, level, node, box)) return;
  if (level == 0) {
    leaf(node);
    return;
  }
  const std::size_t first = node * kRayBranching, last = first + kRayBranching;
  const std::size_t end = last < levels.size[0] ? last : levels.size[0];
  for (std::size_t i = first; i < end; ++i)
    if (meets(levels.level[0][i], box) && !leaf(i)) return;
}

/// Whether a ray of a leaf may intersect the box.
RAYSHEAF_HD inline bool leaf_meets(const RayState& state, std::size_t leaf, const Box& box) {
  const std::size_t first = leaf * kRayBranching, last = first + kRayBranching;
  const std::size_t end = last < state.rays.size ? last : state.rays.size;
  for (std::size_t i = first; i < end; ++i)
    if (may_meet(state.rays.data[i], box)) return true;
  return false;
}

/// The level whose nodes are the items of a loop over `boxes` boxes, chosen so that there are not
/// too many items and their work is similar.
inline std::uint32_t item_level(const RayLevels& levels, std::size_t boxes) {
  return levels.count > 1 && boxes * levels.size[0] > (std::size_t{1} << 23) ? 1 : 0;
}

// --- rays

/// Computes the rays' sort keys and numbers.
template <class Device>
void key_rays_on(Device& device, View<const Ray> rays, const Box& scene, std::uint64_t* keys,
                 std::uint32_t* numbers) {
  device.for_each("rays: keys", rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    keys[i] = ray_place(rays.data[i], scene, kRayKeyAxisBits);
    numbers[i] = static_cast<std::uint32_t>(i);
  });
}

/// Computes the leaves' shafts and their tests.
template <class Device>
void bound_stream_leaves_on(Device& device, View<const Ray> rays, const Box& scene,
                            View<Shaft> shafts, BeamTest* tests) {
  device.for_each("rays: leaves", shafts.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t first = i * kRayBranching, left = rays.size - first;
    const std::size_t count = left < kRayBranching ? left : kRayBranching;
    bound_rays(View<const Ray>(rays.data + first, count), scene, &shafts.data[i]);
    tests[i] = make_node_test(shafts.data[i]);
  });
}

/// Computes those of the level above `below`.
template <class Device>
void bound_stream_level_on(Device& device, View<const Shaft> below, View<Shaft> shafts,
                           BeamTest* tests) {
  device.for_each("rays: levels", shafts.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t first = i * kRayBranching, left = below.size - first;
    const std::size_t count = left < kRayBranching ? left : kRayBranching;
    bound_children(View<const Shaft>(below.data + first, count), &shafts.data[i]);
    tests[i] = make_node_test(shafts.data[i]);
  });
}

template <class Device>
void miss_all_on(Device& device, View<StreamHit> hits) {
  device.for_each("rays: answers", hits.size,
                  [=] RAYSHEAF_DEVICE(std::size_t i) { hits.data[i] = StreamHit{}; });
}

/// Shortens rays that hit something in an earlier run. One of the answers is null.
template <class Device>
void resume_on(Device& device, const RayState& state, const StreamHit* hits,
               const std::uint8_t* occluded) {
  device.for_each("rays: answers", state.rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint32_t number = state.numbers[i];
    if (hits != nullptr && hits[number].block != kInvalidId)
      state.rays.data[i].t_max = hits[number].hit.t;
    if (occluded != nullptr && occluded[number] != 0) {
      state.numbers[i] = kInvalidId;
      state.rays.data[i].t_max = -1;
    }
  });
}

template <class Device>
void flag_left_on(Device& device, View<const std::uint32_t> numbers, std::uint8_t* left) {
  device.for_each("rays: left", numbers.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    left[i] = numbers.data[i] != kInvalidId ? 1 : 0;
  });
}

// --- boxes

/// words[b]: the least squared distance between boxes[b] and the origins of a leaf that intersects
/// it, as a word; all bits are set if no leaf does.
template <class Device>
void distances_on(Device& device, const RayState& state, View<const Shaft> leaves,
                  View<const Box> boxes, View<std::uint32_t> words) {
  device.fill("cull: distances", words, 0xff);
  const std::uint32_t level = item_level(state.levels, boxes.size);
  const std::size_t nodes = state.levels.size[level];
  device.for_each("cull: distances", boxes.size * nodes, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t b = i / nodes;
    const Box box = boxes.data[b];
    for_leaves_met(state.levels, level, i % nodes, box, [&](std::size_t leaf) {
      lower_to(&words.data[b], float_bits(squared_gap(leaves.data[leaf].origins, box)));
      return true;
    });
  });
}

/// Sets met[b] to 1 if a ray may intersect box b of the window's first `count`.
template <class Device>
void meets_on(Device& device, const RayState& state, const BoxWindow& window, std::size_t count,
              std::uint32_t* met) {
  device.fill("cull: boxes", View<std::uint32_t>(met, count), 0);
  const std::uint32_t level = item_level(state.levels, count);
  const std::size_t nodes = state.levels.size[level];
  device.for_each("cull: boxes", count * nodes, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::size_t b = i / nodes;
    const Box box = window.box[b];
    for_leaves_met(state.levels, level, i % nodes, box, [&](std::size_t leaf) {
      if (!leaf_meets(state, leaf, box)) return true;
      raise_flag(&met[b]);
      return false;
    });
  });
}

// --- blocks

/// One block that streams past, and the data that it is tested with.
struct BlockPassage {
  RayState state;
  BlockView block;
  LinearTreeView tree;
  const SharedBox* bounds = nullptr;  ///< of the tree
  Facing facing = Facing::kBoth;
  StreamHit* hits = nullptr;  ///< by the caller's numbers
  std::uint8_t* occluded = nullptr;
  WalkCounts* counts = nullptr;      ///< by the caller's numbers; null: nothing is counted
  std::uint64_t* changed = nullptr;  ///< number of changed rays
  std::uint32_t* met = nullptr;      ///< becomes 1 if a ray reaches the block's tree
};

/// Writes three corners per triangle, and the flags, if any: one for all, or one each.
template <class Device>
void spread_triangles_on(Device& device, const BlockView& block, View<const std::uint8_t> sides,
                         Vec3* corners, std::uint8_t* flags) {
  device.for_each("trace: triangles", block.count(), [=] RAYSHEAF_DEVICE(std::size_t i) {
    for (std::size_t k = 3 * i; k < 3 * i + 3; ++k)
      corners[k] = block.positions.data[block.corners[k]];
    if (!sides.empty()) flags[i] = sides.data[sides.size == 1 ? 0 : i];
  });
}

/// Whether the ray at a place may intersect the block.
RAYSHEAF_HD inline bool comes_to(const BlockPassage& passage, std::size_t place, const Box& box) {
  const RayState& state = passage.state;
  if (state.numbers[place] == kInvalidId) return false;
  if (!is_reached(state.levels, 0, place / kRayBranching, box)) return false;
  if (!may_meet(state.rays.data[place], box)) return false;
  raise_flag(passage.met);
  return true;
}

RAYSHEAF_HD inline void add_counts(const BlockPassage& passage, std::uint32_t ray,
                                   const WalkCounts& counts) {
  if (passage.counts == nullptr) return;
  passage.counts[ray].box_tests += counts.box_tests;
  passage.counts[ray].triangle_tests += counts.triangle_tests;
}

/// Traces rays through the block's tree, and updates their least hits.
template <class Device>
void closest_in_block_on(Device& device, const BlockPassage& passage) {
  device.for_each("trace: blocks", passage.state.rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Box box = box_of(*passage.bounds);
    if (!comes_to(passage, i, box)) return;
    Ray& ray = passage.state.rays.data[i];
    const std::uint32_t number = passage.state.numbers[i];
    WalkCounts counts;
    const IndexedHit found =
        closest_in_tree(TriangleTree{passage.tree, box, passage.facing}, ray, &counts);
    add_counts(passage, number, counts);
    if (found.triangle == kInvalidId) return;
    if (!take_least(passage.block, found, &passage.hits[number])) return;
    ray.t_max = found.t;
    add_to(passage.changed, 1);
  });
}

/// The same for rays that are done after any hit.
template <class Device>
void any_in_block_on(Device& device, const BlockPassage& passage) {
  device.for_each("trace: blocks", passage.state.rays.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const Box box = box_of(*passage.bounds);
    if (!comes_to(passage, i, box)) return;
    Ray& ray = passage.state.rays.data[i];
    const std::uint32_t number = passage.state.numbers[i];
    WalkCounts counts;
    const bool met = any_in_tree(TriangleTree{passage.tree, box, passage.facing}, ray, &counts);
    add_counts(passage, number, counts);
    if (!met) return;
    passage.occluded[number] = 1;
    passage.state.numbers[i] = kInvalidId;
    ray.t_max = -1;
    add_to(passage.changed, 1);
  });
}

}  // namespace raysheaf
