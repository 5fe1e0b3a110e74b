// Memory that a rebuild of the object tree needs in addition to the tree, kept from one frame to
// the next.
#pragma once

#include <cstdint>
#include <vector>

#include "base/buffer.h"
#include "exec/bucket_sort.h"
#include "object_tree/area_tree.h"

namespace raysheaf {

/// A run of the curve that one task sorts and cuts into leaves and clusters.
struct CurveTask {
  std::uint32_t first = 0, count = 0;  ///< items, by place on the curve
  std::uint32_t leaf_count = 0, quad_count = 0, cluster_count = 0;  ///< computed by the task
  std::uint32_t first_leaf = 0, first_quad = 0, first_cluster = 0;  ///< sums over the preceding
                                                                    ///< tasks
};

/// A triangle that is moved with its key.
struct TriangleRecord {
  Vec3 corner[3];
  std::uint32_t id;
};
static_assert(sizeof(TriangleRecord) == 40);

struct TreeScratch {
  /// Doubled centres in three columns; `sorted` later reuses their memory.
  Buffer<float> centers;
  Buffer<std::uint32_t> strips;        ///< of consecutive triangles (tree_kernels.h), if joined
  Buffer<std::uint64_t> keys;          ///< curve key above the triangle's number or the strip
  Buffer<std::uint64_t> sorted;        ///< the same in the order of the curve
  Buffer<TriangleRecord> records;      ///< in buckets, if the source is not ordered; otherwise
                                       ///< empty
  Buffer<std::uint8_t> leaf_sizes;     ///< items of each leaf, from its task's first on
  Buffer<std::uint8_t> cluster_sizes;  ///< leaves of each cluster, from its task's first on
  BucketSort sort;                     ///< of keys
  Buffer<AreaItem> leaves;             ///< boxes of leaves, with their first quad; in a refit, of
                                       ///< quads
  Buffer<AreaItem> source_leaves;      ///< in the order of the source, if leaves are joined
  Buffer<AreaItem> clusters;           ///< boxes of runs of leaves
  Buffer<std::uint8_t> moved_quads, moved_nodes;  ///< of a refit
  std::vector<CurveTask> tasks;
  AreaTree upper;

  [[nodiscard]] std::size_t memory_bytes() const {
    return centers.capacity_bytes() + strips.capacity_bytes() + keys.capacity_bytes() +
           sorted.capacity_bytes() + records.capacity_bytes() + leaf_sizes.capacity_bytes() +
           cluster_sizes.capacity_bytes() + sort.bytes() + leaves.capacity_bytes() +
           source_leaves.capacity_bytes() + clusters.capacity_bytes() +
           moved_quads.capacity_bytes() + moved_nodes.capacity_bytes() +
           tasks.capacity() * sizeof(CurveTask) + upper.memory_bytes();
  }
};

}  // namespace raysheaf
