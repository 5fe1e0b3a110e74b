// The hits of one batch of rays, by any method.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "levels/level_scene.h"
#include "raysheaf/distributed.h"
#include "render/device/frame_stages.h"
#include "render/frame/batch_tracer.h"
#include "render/frame/device_tracer.h"

namespace raysheaf {

/// Data shared by the batches of a frame, and by the frames of a changing scene: the hierarchies
/// over the triangles, made on first use.
struct TraceCache {
  std::unique_ptr<BatchTracer> ordered;  ///< for methods that order rays
  std::unique_ptr<DualTracer> dual;      ///< for `dual`
  std::unique_ptr<DeviceTracer> device;  ///< for methods on a device
  std::unique_ptr<DeviceStages> stages;  ///< for frames whose fragments stay on the device
  TreeReport tree;                       ///< of the batches since it was last reset
  /// The device that intersects rays with triangles: by brute force, `dual` or `gl10`, or by a ray
  /// hierarchy in raster order or by the keys of `crsh` with spheres and cones, without counting
  /// tests of single rays; null: the CPU.
  const DeviceBackend* backend = nullptr;
  Communicator* ranks = nullptr;  ///< the processes that share batches; null: this is the only one
  /// Rays of `dual` enter the instances of the scene where they stand (levels/level_scene.h); none:
  /// the scene's triangles are placed.
  std::optional<LevelScene> entered;

  /// Null: none.
  [[nodiscard]] const LevelScene* levels() const { return entered ? &*entered : nullptr; }
  /// Each is created on first use.
  [[nodiscard]] BatchTracer& ordered_tracer();
  [[nodiscard]] DeviceTracer& device_tracer(const FlatScene& scene);
  [[nodiscard]] DualTracer& dual_tracer(const FlatScene& scene);
  /// Updates the tree of `dual`; returns the time and the reasons.
  QueryReport prepare_tree(const Executor& executor, const FlatScene& scene);
  /// The scene's triangles have moved or were replaced.
  void update(const Executor& executor, const FlatScene& scene, const FlatUpdate& update);
  /// The same where `stages` have moved them already.
  void forget_places();
};

struct TraceOptions : BatchOptions {
  TraceCache* cache = nullptr;  ///< of this scene; null: nothing is shared
};

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
