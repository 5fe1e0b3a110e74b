// The tree of `gl10`: a bounding volume hierarchy over triangles with eight boxes per node, rebuilt
// for each frame.
//
//   depth 0         [ . . . . . . . . ]
//   depth 1         [ . . . . ]   [ . . . ]   ...        a dot: the box of a node or of a leaf
//   triangles  7 2 9 | 4 0 | 1 8 3 5 | ...               leaves are runs of this list
//
// Nodes are stored in breadth-first order, so that a level-by-level traversal streams through them.
#pragma once

#include <cstdint>
#include <vector>

#include "base/aligned.h"
#include "base/view.h"
#include "exec/executor.h"
#include "object_tree/bvh_node.h"
#include "paper/base/triangle_view.h"

namespace raysheaf {

inline constexpr std::uint32_t kLeafTriangles = 8;

struct Bvh {
  AlignedVector<BvhNode> nodes;          ///< [0] is the root; empty without triangles
  std::vector<std::uint32_t> triangles;  ///< every triangle's number, once
  std::uint32_t leaf_count = 0;          ///< of at most `kLeafTriangles` triangles
  std::uint32_t depth = 0;               ///< the number of levels of nodes
};

/// Builds by the surface area heuristic (object_tree/area_tree.h). O(M log M) work; the same tree
/// with any number of threads, and for the same corners in either layout.
[[nodiscard]] Bvh build_bvh(const Executor& executor, const TriangleView& triangles);
/// `corners`: three per triangle.
[[nodiscard]] Bvh build_bvh(const Executor& executor, View<const Vec3> corners);

}  // namespace raysheaf
