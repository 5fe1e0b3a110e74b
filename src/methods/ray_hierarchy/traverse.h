// Stage 5: the ray hierarchy against the geometry, level by level, and the final tests.
//
// A top node meets the bounds of meshes first (`crsh`) or all triangles (`rah`); the triangles that
// are left are tested with the node, those it meets with each of its children, and so on; a leaf's
// rays are tested with the triangles that the leaf met (Roger, Assarsson, Holzschuch 2007; Reis,
// Costa, Pereira 2017, sections 3.5-3.6).
//
// The hit list of a node is compacted: survivors stand side by side in their old order, as a scan
// of the survivors' flags would place them. Lists hold at most kListCapacity triangles. A top node
// whose list is full descends with what it has and then goes on: memory is bounded by levels *
// kListCapacity a thread, whatever the scene, and no work is dropped.
#pragma once

#include <cstdint>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "intersect/intersect_list.h"
#include "scene/flat_scene.h"
#include "methods/ray_hierarchy/hierarchy.h"

namespace raysheaf {

inline constexpr std::uint32_t kListCapacity = 8192;

struct TraverseOptions {
  bool mesh_culling = true;  ///< test bounds of meshes before their triangles
  bool early_out = false;    ///< rays that met something are tested no more
  Facing facing = Facing::kBoth;
};

/// Tests as the paper counts them: the last node of a level as if it were full.
struct TraverseCounts {
  std::uint64_t mesh_sphere_tests = 0;
  std::vector<std::uint64_t> tests, hits;  ///< [0] is level 1
  std::uint64_t final_tests = 0;
  double node_seconds = 0, final_seconds = 0;  ///< summed over threads
};

/// `rays` are those that `tree` was built over, in its order; `best[i]` takes the hits of rays[i].
/// Where `ray_tests` is not empty, ray_tests[i] grows by the tests of ray i: its own, and its share
/// of those of the nodes above it. `meter` advances by top nodes.
/// Defined for the bounds of the family (geom/bounds.h).
template <class Bound>
TraverseCounts traverse(const Executor& executor, const FlatScene& scene,
                        const RayHierarchy<Bound>& tree, View<const Ray> rays,
                        const TraverseOptions& options, View<RayHit> best, View<float> ray_tests,
                        ProgressMeter* meter);

}  // namespace raysheaf
