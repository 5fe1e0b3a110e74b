// The renderer's batches on a device: a DeviceEngine (engine/device_engine.h) on a flat scene.
#pragma once

#include <memory>
#include <vector>

#include "engine/device_engine.h"
#include "raygen/raygen.h"
#include "raysheaf/statistics.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// One scene's, for any number of batches: the triangles are copied to the device once, and its
/// tree is built by the first batch that needs it.
class DeviceTracer {
 public:
  /// O(triangles). `scene` must outlive it.
  DeviceTracer(const Executor& executor, const FlatScene& scene, const DeviceBackend& backend);

  /// As `DualTracer::trace`, or by brute force.
  [[nodiscard]] std::vector<RayHit> trace(const Executor& executor, const RayBatch& batch,
                                          Facing facing, bool brute, BatchStatistics* statistics,
                                          View<float> ray_tests);

 private:
  std::unique_ptr<DeviceEngine> engine_;
  Buffer<EngineHit> closest_;
  Buffer<std::uint8_t> occluded_;
};

}  // namespace raysheaf
