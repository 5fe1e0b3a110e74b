// A flat scene on a device: the tracer of a method that orders rays, for frames by it, and a
// DeviceQueries for rays that the host traces before a frame begins.
#pragma once

#include <memory>
#include <vector>

#include "device/backend.h"
#include "device/device_queries.h"
#include "render/frame/batch_tracer.h"

namespace raysheaf {

/// For one scene, until it changes.
class DeviceTracer {
 public:
  /// Both must outlive it. Copies nothing until it is needed.
  DeviceTracer(const FlatScene& scene, const DeviceBackend& backend)
      : scene_(scene), backend_(backend) {}

  /// The scene's triangles have changed; `same_triangles`: they have only moved.
  void forget_scene(bool same_triangles) {
    ordered_knows_ = engine_knows_ = false;
    same_triangles_ = same_triangles_ && same_triangles;
  }

  /// The closest hits of a few rays of the host, for every method of the frame.
  [[nodiscard]] std::vector<RayHit> trace(const Executor& executor, const RayBatch& batch,
                                          Facing facing);

  /// The tracer of a method that orders rays, with the scene, whose triangles, `there`, stay in the
  /// device's memory until they change. Work on a hierarchy over them is added to `tree`.
  [[nodiscard]] DeviceBatchTracer& ordered(const Executor& executor, Traversal traversal,
                                           const TriangleList& there, TreeReport* tree);

 private:
  [[nodiscard]] DeviceQueries& engine(const Executor& executor);

  const FlatScene& scene_;
  const DeviceBackend& backend_;
  std::unique_ptr<DeviceBatchTracer> ordered_;
  Traversal ordered_by_ = Traversal::kRayHierarchy;
  std::unique_ptr<DeviceQueries> engine_;
  bool ordered_knows_ = false, engine_knows_ = false;  ///< whether they have the scene
  bool same_triangles_ = false;                        ///< those of the engine, only moved
};

}  // namespace raysheaf
