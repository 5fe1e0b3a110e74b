// A binary tree over triangles along a Morton curve, made by a loop over its nodes, all at once.
//
//   keys    0001  0010  0100  0101  1001 ...    ascending and all different: a cell, then a number
//   node i  begins or ends at place i; its run is the longest about i whose keys share a prefix
//   that
//           the neighbour on its other side does not share; it is cut where they first differ
//
// T. Karras, "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees", HPG
// 2012, sections 3 and 4. A run of at most kLinearLeaf triangles is a leaf. Boxes come from below:
// of two who arrive at a node, the second goes on. When the tree is built, it first looks whether a
// child and a child of the other had better change places.
#pragma once

#include <cstdint>
#include <limits>

#include "base/bits.h"
#include "base/vec.h"
#include "exec/atomic.h"
#include "geom/ray_end.h"
#include "raygen/key_body.h"

namespace raysheaf {

inline constexpr std::uint32_t kLinearLeaf = 4;
/// Keys have 64 bits, and each node on a way down shares more of them.
inline constexpr std::uint32_t kLinearDepth = 64;
/// A child that is a leaf: the place of its first triangle.
inline constexpr std::uint32_t kLeafBit = 0x80000000u;

/// A triangle at its place along the curve.
struct alignas(16) LinearTriangle {
  Vec3 a;
  std::uint32_t id = 0;  ///< its number
  Vec3 b;
  std::uint32_t flags = 0;  ///< TriangleFlag
  Vec3 c;
  std::uint32_t ends_leaf = 0;  ///< 1 where it is the last of its leaf
};
static_assert(sizeof(LinearTriangle) == 48);

struct alignas(64) LinearNode {
  Box box[2];              ///< of the children
  std::uint32_t child[2];  ///< a node, or a place with kLeafBit
  std::uint32_t height;    ///< of the nodes from here down to the farthest leaf
};
static_assert(sizeof(LinearNode) == 64);

/// [0] is the root of more than kLinearLeaf triangles; of fewer, there are no nodes and one leaf.
struct LinearTreeView {
  const LinearNode* nodes = nullptr;
  const LinearTriangle* triangles = nullptr;
  std::uint32_t count = 0;
};

/// Floats as words in the same order: -0 just before +0.
RAYSHEAF_HD inline std::uint32_t ordered_word(float x) {
  const std::uint32_t bits = float_bits(x);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}
RAYSHEAF_HD inline float float_of_word(std::uint32_t word) {
  return bits_float((word & 0x80000000u) != 0 ? word & 0x7fffffffu : ~word);
}

/// A box that many threads enlarge: what is lowered are its minimum and its maximum's opposite. All
/// bits set is the empty one.
struct SharedBox {
  std::uint32_t word[6];
};
RAYSHEAF_HD inline SharedBox shared_box(const Box& box) {
  return {{ordered_word(box.min.x), ordered_word(box.min.y), ordered_word(box.min.z),
           ordered_word(-box.max.x), ordered_word(-box.max.y), ordered_word(-box.max.z)}};
}
RAYSHEAF_HD inline void enlarge(SharedBox* shared, const Box& box) {
  const SharedBox words = shared_box(box);
  for (int i = 0; i < 6; ++i) lower_to(&shared->word[i], words.word[i]);
}
RAYSHEAF_HD inline Box box_of(const SharedBox& shared) {
  const auto low = [&](int i) { return float_of_word(shared.word[i]); };
  return {{low(0), low(1), low(2)}, {-low(3), -low(4), -low(5)}};
}

RAYSHEAF_HD inline Box triangle_box(Vec3 a, Vec3 b, Vec3 c) {
  return {min(min(a, b), c), max(max(a, b), c)};
}

/// How keys are made up.
struct LinearKeys {
  std::uint32_t id_bits = 1, axis_bits = 16;

  RAYSHEAF_HD explicit LinearKeys(std::uint32_t count) {
    const std::uint32_t needed = bits_for(count), most = (64 - needed) / 3;
    id_bits = needed > 1 ? needed : 1;
    axis_bits = most < 16 ? most : 16;
  }
  [[nodiscard]] std::uint32_t bits() const { return id_bits + 3 * axis_bits; }
};

/// The cell of a triangle's centre in the cube of the scene's box, above its number.
RAYSHEAF_HD inline std::uint64_t linear_key(const LinearKeys& keys, const Box& scene,
                                            const Box& box, std::uint32_t id) {
  const Vec3 center = box.min * 0.5f + box.max * 0.5f;
  const Cell<3> cell = cube_cell(key_cube(scene), center, keys.axis_bits);
  return morton_place(cell) << keys.id_bits | id;
}

/// The number of leading bits that the keys at two places share; -1 beyond the ends.
RAYSHEAF_HD inline int shared_prefix(const std::uint64_t* keys, std::int64_t count, std::int64_t i,
                                     std::int64_t j) {
  if (j < 0 || j >= count) return -1;
  return leading_zeros(keys[i] ^ keys[j]);
}

struct LinearRun {
  std::uint32_t first, last;  ///< both are in it
  std::uint32_t cut;          ///< the last place of its first part
};

/// The run of node `i`, one of count - 1; count from 2.
RAYSHEAF_HD inline LinearRun linear_run(const std::uint64_t* keys, std::uint32_t count,
                                        std::uint32_t i) {
  const auto prefix = [&](std::int64_t j) { return shared_prefix(keys, count, i, j); };
  const std::int64_t at = i, step = prefix(at + 1) > prefix(at - 1) ? 1 : -1;
  const int outside = prefix(at - step);
  std::int64_t most = 2;
  while (prefix(at + most * step) > outside) most *= 2;
  std::int64_t length = 0;
  for (std::int64_t half = most / 2; half >= 1; half /= 2)
    if (prefix(at + (length + half) * step) > outside) length += half;
  const std::int64_t other = at + length * step;
  // Where the run's prefix ends, from the end that is not i's own neighbour.
  const std::int64_t first = at < other ? at : other, last = at < other ? other : at;
  const int common = prefix(other);
  std::int64_t low = first, high = last;  // low has the bit clear, high has it set
  while (high - low > 1) {
    const std::int64_t middle = low + (high - low) / 2;
    if (shared_prefix(keys, count, first, middle) > common) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last),
          static_cast<std::uint32_t>(low)};
}

/// A child's number and side, as its parent is remembered: 2 * node + side; kInvalidId: none.
struct LinearParents {
  std::uint32_t* of_node;
  std::uint32_t* of_leaf;  ///< by the leaf's first place
};

/// Writes node `i`'s children and their parent, where its run is no part of a leaf.
RAYSHEAF_HD inline void link_node(const std::uint64_t* keys, std::uint32_t count, std::uint32_t i,
                                  LinearNode* nodes, LinearTriangle* triangles,
                                  LinearParents parents) {
  const LinearRun run = linear_run(keys, count, i);
  if (run.last - run.first < kLinearLeaf) return;
  const std::uint32_t first[2] = {run.first, run.cut + 1}, last[2] = {run.cut, run.last};
  for (std::uint32_t side = 0; side < 2; ++side) {
    const bool leaf = last[side] - first[side] < kLinearLeaf;
    const std::uint32_t node = side == 0 ? run.cut : run.cut + 1;
    nodes[i].child[side] = leaf ? first[side] | kLeafBit : node;
    (leaf ? parents.of_leaf[first[side]] : parents.of_node[node]) = 2 * i + side;
    if (leaf) triangles[last[side]].ends_leaf = 1;
  }
}

/// Half the surface of a box within the scene's, in parts that are the scene's longest side squared
/// over 2^20: a ray that meets the scene meets its boxes as often as their surfaces are large, and
/// sums of whole numbers are the same in any order. 0 where that side is 0, or no number.
RAYSHEAF_HD inline std::uint64_t surface_parts(const Box& box, const Box& scene) {
  const Vec3 sides = scene.max - scene.min;
  const float longest = max_component(sides);
  if (!(longest > 0 && longest <= std::numeric_limits<float>::max())) return 0;
  const Vec3 d = (box.max - box.min) * (1 / longest);
  const float half = d.x * d.y + d.y * d.z + d.z * d.x;
  return half > 0 && half <= 4 ? static_cast<std::uint64_t>(half * 0x1p20f) : 0;
}

/// Where a node's children and their children may change places.
struct LinearSwap {
  std::uint32_t side = 0, grandchild = 0;  ///< the child that is opened, and which of its children
  float gain = 0;                          ///< of half surfaces; 0: nothing is to be gained
  std::uint32_t height = 0;                ///< of the child that is opened
};

RAYSHEAF_HD inline std::uint32_t height_of(const LinearNode* nodes, std::uint32_t child) {
  return (child & kLeafBit) != 0 ? 0 : nodes[child].height;
}
RAYSHEAF_HD inline float half_surface(const Box& box) {
  const Vec3 d = box.max - box.min;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

/// The swap of a child with a child of the other that makes the other's box smallest (A. Kensler,
/// "Tree Rotations for Improving Bounding Volume Hierarchies", 2008). No way down gets longer than
/// the longest below the node was.
RAYSHEAF_HD inline LinearSwap best_swap(const LinearNode* nodes, const LinearNode& node) {
  LinearSwap best;
  for (std::uint32_t side = 0; side < 2; ++side) {
    if ((node.child[side] & kLeafBit) != 0) continue;
    const LinearNode& opened = nodes[node.child[side]];
    const std::uint32_t other_height = height_of(nodes, node.child[1 - side]);
    const float now = half_surface(node.box[side]);
    for (std::uint32_t k = 0; k < 2; ++k) {
      const float then = half_surface(box_union(node.box[1 - side], opened.box[1 - k]));
      const std::uint32_t kept_height = height_of(nodes, opened.child[1 - k]);
      const std::uint32_t height = 1 + (other_height > kept_height ? other_height : kept_height);
      if (now - then > best.gain && height < node.height) best = {side, k, now - then, height};
    }
  }
  return best;
}

/// Swaps what `best_swap` found.
RAYSHEAF_HD inline void swap_children(LinearNode* nodes, std::uint32_t at, const LinearSwap& swap,
                                      LinearParents parents) {
  const auto set_parent = [&](std::uint32_t child, std::uint32_t parent) {
    ((child & kLeafBit) != 0 ? parents.of_leaf[child & ~kLeafBit] : parents.of_node[child]) =
        parent;
  };
  LinearNode& node = nodes[at];
  const std::uint32_t side = swap.side, other = 1 - side, k = swap.grandchild;
  const std::uint32_t opened_at = node.child[side], down = node.child[other];
  LinearNode& opened = nodes[opened_at];
  const std::uint32_t up = opened.child[k];
  const Box down_box = node.box[other];
  node.child[other] = up;
  node.box[other] = opened.box[k];
  opened.child[k] = down;
  opened.box[k] = down_box;
  opened.height = swap.height;
  node.box[side] = box_union(opened.box[0], opened.box[1]);
  set_parent(up, 2 * at + other);
  set_parent(down, 2 * opened_at + k);
}

/// Where a leaf begins at `place`: its box to its parent, and on up until a node waits for its
/// other child. `arrived` has a zero for each node. `turns`: children that would be better off
/// elsewhere go there. Returns the sum of `surface_parts` of the boxes that were found.
RAYSHEAF_HD inline std::uint64_t fit_boxes(const LinearTriangle* triangles, std::uint32_t place,
                                           const SharedBox& scene, LinearParents parents,
                                           std::uint32_t* arrived, LinearNode* nodes, bool turns) {
  std::uint32_t up = parents.of_leaf[place];
  if (up == kInvalidId) return 0;
  const Box whole = box_of(scene);
  std::uint64_t surface = 0;
  Box box;
  for (bool more = true; more; ++place) {
    const LinearTriangle& t = triangles[place];
    box = box_union(box, triangle_box(t.a, t.b, t.c));
    more = t.ends_leaf == 0;
  }
  for (;;) {
    const std::uint32_t at = up / 2;
    LinearNode& node = nodes[at];
    node.box[up & 1] = box;
    surface += surface_parts(box, whole);
    if (arrive_at(&arrived[at]) == 0) return surface;
    if (turns) {
      const std::uint32_t heights[2] = {height_of(nodes, node.child[0]),
                                        height_of(nodes, node.child[1])};
      node.height = 1 + (heights[0] > heights[1] ? heights[0] : heights[1]);
      const LinearSwap swap = best_swap(nodes, node);
      if (swap.gain > 0) {
        surface -= surface_parts(node.box[swap.side], whole);
        swap_children(nodes, at, swap, parents);
        surface += surface_parts(node.box[swap.side], whole);
        const std::uint32_t kept = height_of(nodes, node.child[1 - swap.side]);
        node.height = 1 + (kept > swap.height ? kept : swap.height);
      }
    }
    if (at == 0) return surface;
    box = box_union(node.box[0], node.box[1]);
    up = parents.of_node[at];
  }
}

}  // namespace raysheaf
