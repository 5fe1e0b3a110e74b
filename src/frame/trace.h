// Stages 3 to 6 for one batch of rays: order, hierarchy, traverse, intersect.
#pragma once

#include <optional>
#include <vector>

#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "intersect/intersect_list.h"
#include "object/bvh.h"
#include "raygen/raygen.h"
#include "raysheaf/method.h"
#include "raysheaf/statistics.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// What batches of one frame share: the triangles' hierarchy, made by the first that needs it.
struct TraceCache {
  std::optional<Bvh> bvh;
};

struct TraceOptions {
  MethodSettings method;
  Facing facing = Facing::kBoth;
  bool early_out = false;       ///< for rays of which only matters whether they meet something
  TraceCache* cache = nullptr;  ///< of this scene; none: nothing is shared
};

/// The hits of a batch, in the batch's order. Adds to `statistics`; where `ray_tests` is not empty,
/// adds each ray's tests to it.
std::vector<RayHit> trace(const Executor& executor, const FlatScene& scene, const RayBatch& batch,
                          const TraceOptions& options, BatchStatistics* statistics,
                          View<float> ray_tests, ProgressMeter* meter);

}  // namespace raysheaf
