// Stages 3 to 6 for one batch of rays: order, hierarchy, traverse, intersect.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "exec/executor.h"
#include "exec/progress_meter.h"
#include "intersect/intersect_list.h"
#include "methods/packets/bvh.h"
#include "rays/raygen.h"
#include "raysheaf/distributed.h"
#include "raysheaf/method.h"
#include "raysheaf/statistics.h"
#include "render/device/frame_stages.h"
#include "render/frame/device_tracer.h"
#include "render/frame/dual_tracer.h"
#include "scene/flat_arrays.h"

namespace raysheaf {

/// Data shared by the batches of a frame, and by the frames of a changing scene: the hierarchies
/// over the triangles, made on first use.
struct TraceCache {
  std::optional<FlatArrays> arrays;      ///< for brute force, `rah`, `crsh` and `gl10`
  std::optional<Bvh> bvh;                ///< for `gl10`
  std::unique_ptr<DualTracer> dual;      ///< for `dual`
  std::unique_ptr<DeviceTracer> device;  ///< for methods on a device
  std::unique_ptr<DeviceStages> stages;  ///< for frames whose fragments stay on the device
  TreeReport tree;                       ///< of the batches since it was last reset
  /// The device that intersects rays with triangles: by brute force, `dual` or `gl10`, or by a ray
  /// hierarchy in raster order or by the keys of `crsh` with spheres and cones, without counting
  /// tests of single rays; null: the CPU.
  const DeviceBackend* backend = nullptr;
  Communicator* ranks = nullptr;  ///< the processes that share batches; null: this is the only one

  /// Each is created on first use.
  [[nodiscard]] TriangleView triangles(const Executor& executor, const FlatScene& scene);
  [[nodiscard]] DeviceTracer& device_tracer(const FlatScene& scene);
  [[nodiscard]] const Bvh& hierarchy(const Executor& executor, const FlatScene& scene);
  [[nodiscard]] DualTracer& dual_tracer(const FlatScene& scene);
  /// Updates the tree of `dual`; returns the time and the reasons.
  QueryReport prepare_tree(const Executor& executor, const FlatScene& scene);
  /// The scene's triangles have moved or were replaced.
  void update(const Executor& executor, const FlatScene& scene, const FlatUpdate& update);
  /// The same where `stages` have moved them already.
  void forget_places();
};

struct TraceOptions {
  MethodSettings method;
  Facing facing = Facing::kBoth;
  std::uint32_t bundle_samples = 0;  ///< number of bundles to measure per level
  bool early_out = false;            ///< for rays of which only occlusion matters
  TraceCache* cache = nullptr;       ///< of this scene; null: nothing is shared
};

/// The stable order of the rays by the method's keys; adds the number of runs of equal keys to
/// `statistics`.
[[nodiscard]] std::vector<std::uint32_t> ray_order(const Executor& executor, const RayBatch& batch,
                                                   const Box& scene_bounds,
                                                   const MethodSettings& method,
                                                   BatchStatistics* statistics);

/// The hits of a batch, in the batch's order. Adds to `statistics` and, if `ray_tests` is not
/// empty, each ray's tests to it; on a device, which renders its own frames, tests are not counted.
/// `dual` does not name the triangles of occlusion rays (`asks_occlusion`): only `found()` of their
/// hits may be used.
std::vector<RayHit> trace(const Executor& executor, const FlatScene& scene, const RayBatch& batch,
                          const TraceOptions& options, BatchStatistics* statistics,
                          View<float> ray_tests, ProgressMeter* meter);

/// Whether rays gain little from the others of their batch, so that many are best traced in parts
/// that stay in the caches: true for `dual` on the CPU.
[[nodiscard]] bool asks_alone(const TraceOptions& options);

}  // namespace raysheaf
