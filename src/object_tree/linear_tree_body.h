// A binary tree over triangles along a Morton curve: its data structures, and the refit of its
// boxes. object_tree/linear_build_body.h builds its nodes.
//
//   keys   0001  0010  0100  0101  1001 ...   ascending and all different: a cell, then a number
//   runs   those whose keys share a prefix that their neighbours do not share. A run of at most
//          kLinearLeaf triangles that is not part of another such run is a leaf
//
// Boxes are computed bottom-up: of the two threads that arrive at a node, the second continues.
#pragma once

#include <cstdint>
#include <limits>

#include "base/bits.h"
#include "base/vec.h"
#include "exec/atomic.h"
#include "geom/ray_end.h"
#include "rays/ray_place_body.h"

namespace raysheaf {

inline constexpr std::uint32_t kLinearLeaf = 4;
/// No path from the root has more nodes (`join_runs`).
inline constexpr std::uint32_t kLinearDepth = 64;
/// Marks a child that is a leaf, given by the place of its first triangle.
inline constexpr std::uint32_t kLeafBit = 0x80000000u;

/// A triangle at its place along the curve.
struct alignas(16) LinearTriangle {
  Vec3 a;
  std::uint32_t id = 0;  ///< its number
  Vec3 b;
  std::uint32_t flags = 0;  ///< TriangleFlag
  Vec3 c;
  std::uint32_t ends_leaf = 0;  ///< 1 for the last of its leaf
};
static_assert(sizeof(LinearTriangle) == 48);

struct alignas(64) LinearNode {
  Box box[2];              ///< of the children
  std::uint32_t child[2];  ///< a node, or a place with kLeafBit
  std::uint32_t height;    ///< number of nodes from here down to the farthest leaf
};
static_assert(sizeof(LinearNode) == 64);

/// [0] is the root of more than kLinearLeaf triangles; fewer have no nodes and one leaf.
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

/// A box that many threads enlarge: atomic minima lower its minimum and its negated maximum. It is
/// empty if all bits are set.
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

/// The format of keys.
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

/// For each child, its parent's number and its side: 2 * node + side; kInvalidId: none.
struct LinearParents {
  std::uint32_t* of_node;
  std::uint32_t* of_leaf;  ///< by the leaf's first place
};

RAYSHEAF_HD inline void set_parent(LinearParents parents, std::uint32_t child,
                                   std::uint32_t parent) {
  ((child & kLeafBit) != 0 ? parents.of_leaf[child & ~kLeafBit] : parents.of_node[child]) = parent;
}

/// Half the surface of a box within the scene's, in units of the scene's longest side squared over
/// 2^20. A ray through the scene intersects boxes with probabilities in proportion to their
/// surfaces, and sums of integers are the same in any order. 0 if that side is 0 or NaN.
RAYSHEAF_HD inline std::uint64_t surface_parts(const Box& box, const Box& scene) {
  const Vec3 sides = scene.max - scene.min;
  const float longest = max_component(sides);
  if (!(longest > 0 && longest <= std::numeric_limits<float>::max())) return 0;
  const Vec3 d = (box.max - box.min) * (1 / longest);
  const float half = d.x * d.y + d.y * d.z + d.z * d.x;
  return half > 0 && half <= 4 ? static_cast<std::uint64_t>(half * 0x1p20f) : 0;
}

/// Calls `take(triangle, place)` for the triangles of the leaf that begins at `place`.
template <class Take>
RAYSHEAF_HD void for_each_of_leaf(const LinearTriangle* triangles, std::uint32_t place,
                                  const Take& take) {
  for (bool more = true; more; ++place) {
    const LinearTriangle triangle = triangles[place];
    more = triangle.ends_leaf == 0;
    take(triangle, place);
  }
}

RAYSHEAF_HD inline Box leaf_box(const LinearTriangle* triangles, std::uint32_t place) {
  Box box;
  for_each_of_leaf(triangles, place, [&](const LinearTriangle& t, std::uint32_t) {
    box = box_union(box, triangle_box(t.a, t.b, t.c));
  });
  return box;
}

/// If a leaf begins at `place`, passes its box to its parent, and continues upwards until a node
/// waits for its other child. `arrived` must have a zero for each node. Returns the sum of
/// `surface_parts` of the computed boxes.
RAYSHEAF_HD inline std::uint64_t fit_boxes(const LinearTriangle* triangles, std::uint32_t place,
                                           const SharedBox& scene, LinearParents parents,
                                           std::uint32_t* arrived, LinearNode* nodes) {
  std::uint32_t up = parents.of_leaf[place];
  if (up == kInvalidId) return 0;
  const Box whole = box_of(scene);
  std::uint64_t surface = 0;
  Box box = leaf_box(triangles, place);
  for (;;) {
    const std::uint32_t at = up / 2;
    LinearNode& node = nodes[at];
    node.box[up & 1] = box;
    surface += surface_parts(box, whole);
    if (at == 0 || arrive_at(&arrived[at]) == 0) return surface;
    box = box_union(node.box[0], node.box[1]);
    up = parents.of_node[at];
  }
}

}  // namespace raysheaf
