// Methods that order the rays of a batch before they trace them: `rah`, `crsh` and `gl10`. They are
// a library of their own (paper/), which tells the renderer here how they are made.
#pragma once

#include <memory>
#include <vector>

#include "exec/progress_meter.h"
#include "render/device/device_batch_tracer.h"
#include "render/frame/dual_tracer.h"
#include "render/rays/raygen.h"

namespace raysheaf {

/// Traces the batches of one scene on the CPU, by any of these methods.
class BatchTracer {
 public:
  virtual ~BatchTracer() = default;
  /// Reads the scene's triangles, unless it has them, as `trace` does.
  virtual void prepare(const Executor& executor, const FlatScene& scene) = 0;
  /// Updates after the scene's change `update`.
  virtual void update(const Executor& executor, const FlatScene& scene,
                      const FlatUpdate& update) = 0;
  /// As `trace` of render/frame/trace.h.
  [[nodiscard]] virtual std::vector<RayHit> trace(const Executor& executor, const FlatScene& scene,
                                                  const RayBatch& batch,
                                                  const BatchOptions& options,
                                                  BatchStatistics* statistics,
                                                  View<float> ray_tests, ProgressMeter* meter) = 0;
  /// For all batches since the last call.
  [[nodiscard]] virtual TreeReport take_tree_report() = 0;
};

struct BatchTracers {
  std::unique_ptr<BatchTracer> (*on_cpu)();
  /// For a method on the first CUDA device; null in a build without CUDA.
  std::unique_ptr<DeviceBatchTracer> (*on_cuda)(Traversal traversal);
};

/// Thread-safe. `tracers` must outlive the process's frames; null: there are none.
void set_batch_tracers(const BatchTracers* tracers);
/// Throws `Error` (kUnsupported) if there are none.
[[nodiscard]] const BatchTracers& batch_tracers();

}  // namespace raysheaf
