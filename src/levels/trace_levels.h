// Rays through a scene of two levels, one by one, interleaved.
//
//   ray ─► instances whose boxes it meets, near ones first ─► enters one: the ray in the mesh's
//          space ─► down the mesh's tree ─► where it may hit, corners are placed and tested
//
// A ray enters an instance as one from far away enters a scene (methods/dual/far_ray.h): in
// binary64, with its origin moved to the box of the mesh, and with a pad for what the inverse of
// the transform and the placing round. The answer is that of the flat scene, bit for bit.
#pragma once

#include "intersect/hit_filter.h"
#include "intersect/indexed_hit.h"
#include "levels/level_scene.h"
#include "methods/dual/dual.h"

namespace raysheaf {

/// The instances that a query sees, and which of their hits count.
struct LevelQuery {
  std::uint32_t mask = 0xffffffff;
  const HitFilter* filter = nullptr;  ///< by the numbers of the rays; null: all count
};

/// The results are `hits`, `occluded` or `hit_counts`; rows and tests of single rays are not
/// supported. The rays must have been validated. Adds to `counts`, which may be null; tests of rays
/// with boxes of instances count as those of other boxes.
void trace_levels(const Executor& executor, const LevelScene& scene, View<const Ray> rays,
                  const LevelQuery& query, const DualResults& results, DualCounts* counts);

/// What trace_levels_simd.cpp works on.
struct LevelJob {
  const Executor* executor;  ///< checked for cancellation
  const LevelScene* scene;
  const Ray* rays;
  LevelQuery query;
  DualResults results;
};

}  // namespace raysheaf
