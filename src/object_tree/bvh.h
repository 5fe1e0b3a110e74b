// A bounding volume hierarchy over triangles with eight boxes per node, rebuilt for each frame.
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
#include "intersect/triangle_view.h"

namespace raysheaf {

inline constexpr std::uint32_t kBvhWidth = 8;
inline constexpr std::uint32_t kLeafTriangles = 8;

/// Children [0, children); boxes contain all corners of the triangles below exactly.
struct alignas(kCacheLineBytes) BvhNode {
  float bound[6][kBvhWidth];       ///< rows: min x, y, z, max x, y, z
  std::uint32_t first[kBvhWidth];  ///< for a leaf, its first place in `triangles`; for a node, its
                                   ///< number
  std::uint8_t count[kBvhWidth];   ///< triangles of a leaf, 1 to kLeafTriangles; 0: a node
  std::uint32_t children;

  [[nodiscard]] RAYSHEAF_HD bool is_leaf(std::uint32_t child) const { return count[child] != 0; }
};
static_assert(sizeof(BvhNode) == 256);

struct Bvh {
  AlignedVector<BvhNode> nodes;             ///< [0] is the root; empty without triangles
  std::vector<std::uint32_t> level_starts;  ///< depth d has the nodes from [d] up to, excluding, [d
                                            ///< + 1]
  std::vector<std::uint32_t> triangles;     ///< every triangle's number, once
  std::uint32_t leaf_count = 0;

  [[nodiscard]] std::uint32_t depth() const {
    return level_starts.empty() ? 0 : static_cast<std::uint32_t>(level_starts.size() - 1);
  }
};

/// Builds from the top down: a node splits the child with the largest surface, by the surface area
/// heuristic over bins along the widest axis of the centres (Goldsmith & Salmon 1987; Wald 2007,
/// "On fast Construction of SAH-based Bounding Volume Hierarchies"), until it has eight children or
/// none has more than kLeafTriangles triangles. All nodes of a depth are built in parallel, and
/// large ones also internally. O(M log M) work; the same tree with any number of threads, and on a
/// device (object_tree/bvh_device.h).
[[nodiscard]] Bvh build_bvh(const Executor& executor, const TriangleView& triangles);

}  // namespace raysheaf
