// Stages 3 to 6 for one batch of rays: order, hierarchy, traverse, intersect.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "intersect/intersect_list.h"
#include "object_tree/bvh.h"
#include "rays/raygen.h"
#include "raysheaf/distributed.h"
#include "raysheaf/method.h"
#include "raysheaf/statistics.h"
#include "render/device/frame_stages.h"
#include "render/frame/device_tracer.h"
#include "render/frame/dual_tracer.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// What batches of one frame share, and frames of a scene that changes: the triangles' hierarchies,
/// made by the first that needs them.
struct TraceCache {
  std::optional<Bvh> bvh;                ///< of `gl10`
  std::unique_ptr<DualTracer> dual;      ///< of `dual`
  std::unique_ptr<DeviceTracer> device;  ///< of what runs on a device
  std::unique_ptr<DeviceStages> stages;  ///< of frames whose fragments stay there
  TreeReport tree;                       ///< of the batches since it was last reset
  /// Where rays meet triangles: by brute force or `dual`, or by a hierarchy of rays in raster order
  /// or by the keys of `crsh` under spheres and cones, without tests of single rays; null: the CPU.
  const DeviceBackend* backend = nullptr;
  Communicator* ranks = nullptr;  ///< that batches are shared among; null: this process alone

  /// Each is made where there is none yet.
  [[nodiscard]] DeviceTracer& device_tracer(const FlatScene& scene);
  [[nodiscard]] const Bvh& hierarchy(const Executor& executor, const FlatScene& scene);
  [[nodiscard]] DualTracer& dual_tracer(const Executor& executor, const FlatScene& scene);
  /// Brings the tree of `dual` up to date; what it took, and why.
  QueryReport prepare_tree(const Executor& executor, const FlatScene& scene);
  /// The scene's triangles are others, or elsewhere.
  void update(const Executor& executor, const FlatScene& scene, const FlatUpdate& update);
};

struct TraceOptions {
  MethodSettings method;
  Facing facing = Facing::kBoth;
  std::uint32_t bundle_samples = 0;  ///< bundles of a level that are measured
  bool early_out = false;            ///< for rays of which only matters whether they meet something
  TraceCache* cache = nullptr;       ///< of this scene; none: nothing is shared
};

/// The stable order of the rays by the method's keys; adds how many runs of equal keys there were
/// to `statistics`.
[[nodiscard]] std::vector<std::uint32_t> ray_order(const Executor& executor, const RayBatch& batch,
                                                   const Box& scene_bounds,
                                                   const MethodSettings& method,
                                                   BatchStatistics* statistics);

/// The hits of a batch, in the batch's order. Adds to `statistics`; where `ray_tests` is not empty,
/// adds each ray's tests to it; on a device, whose frames are its own, tests are not counted.
/// `dual` does not name the triangles of rays that ask for occlusion
/// (`asks_occlusion`): of those only `found()` may be used.
std::vector<RayHit> trace(const Executor& executor, const FlatScene& scene, const RayBatch& batch,
                          const TraceOptions& options, BatchStatistics* statistics,
                          View<float> ray_tests, ProgressMeter* meter);

/// Whether rays gain little from the others of their batch, so that many are best traced in parts
/// that stay in the caches: those of `dual` on the CPU.
[[nodiscard]] bool asks_alone(const TraceOptions& options);

}  // namespace raysheaf
