// Stage 5: tests the ray hierarchy with the geometry, level by level, and makes the final tests.
//
// A top node is tested first with the bounds of meshes (`crsh`) or with all triangles (`rah`); the
// remaining triangles are tested with the node, those that it intersects with each of its children,
// and so on; a leaf's rays are tested with the triangles that the leaf intersects (Roger,
// Assarsson, Holzschuch 2007; Reis, Costa, Pereira 2017, sections 3.5-3.6).
//
// The hit list of a node is compacted: survivors are contiguous in their old order, as a scan of
// the survivors' flags would place them. Lists hold at most kListCapacity triangles. A top node
// whose list is full first descends with it and then continues: memory is bounded by levels *
// kListCapacity per thread for any scene, and no work is lost.
#pragma once

#include <cstdint>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "intersect/intersect_list.h"
#include "paper/base/level_counts.h"
#include "paper/base/triangle_view.h"
#include "paper/ray_hierarchy/hierarchy.h"
#include "scene/flat_scene.h"

namespace raysheaf {

inline constexpr std::uint32_t kListCapacity = 8192;

struct TraverseOptions {
  bool mesh_culling = true;  ///< test bounds of meshes before their triangles
  bool early_out = false;    ///< rays are not tested after their first hit
  Facing facing = Facing::kBoth;
};

/// Tests as the paper counts them: the last node of a level as if it were full.
struct TraverseCounts : LevelCounts {
  double node_seconds = 0, final_seconds = 0;  ///< summed over threads
};

/// `rays` are those over which `tree` was built, in its order; `best[i]` receives the hit of
/// rays[i]. If `ray_tests` is not empty, the tests of ray i are added to ray_tests[i]: its own, and
/// its share of those of the nodes above it. `meter` advances by top nodes. Defined for the bounds
/// of paper/bounds/bounds.h.
template <class Bound>
TraverseCounts traverse(const Executor& executor, const TriangleView& triangles,
                        View<const FlatMesh> meshes, const RayHierarchy<Bound>& tree,
                        View<const Ray> rays, const TraverseOptions& options, View<RayHit> best,
                        View<float> ray_tests, ProgressMeter* meter);

}  // namespace raysheaf
