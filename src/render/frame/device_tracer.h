// A flat scene on a device. It has the tracers of the methods that order rays
// (methods/ray_hierarchy/pair_tracer.h, methods/packets/packet_tracer.h), which frames by these
// methods use, and a DeviceQueries for rays that the host traces before a frame begins.
#pragma once

#include <memory>
#include <vector>

#include "device/backend.h"
#include "device/device_queries.h"
#include "methods/packets/packet_tracer.h"
#include "methods/ray_hierarchy/pair_tracer.h"
#include "rays/raygen.h"
#include "raysheaf/statistics.h"
#include "render/frame/dual_tracer.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// For one scene, until it changes.
class DeviceTracer {
 public:
  /// Both must outlive it. Copies nothing until it is needed.
  DeviceTracer(const FlatScene& scene, const DeviceBackend& backend)
      : scene_(scene), backend_(backend) {}

  /// The scene's triangles have changed; `same_triangles`: they have only moved.
  void forget_scene(bool same_triangles) {
    pairs_.knows = packets_.knows = engine_.knows = false;
    same_triangles_ = same_triangles_ && same_triangles;
  }

  /// The closest hits of a few rays of the host, for every method of the frame.
  [[nodiscard]] std::vector<RayHit> trace(const Executor& executor, const RayBatch& batch,
                                          Facing facing);

  /// For `rah` and `crsh`, with the scene, whose triangles stay in the device's memory until they
  /// change.
  [[nodiscard]] PairTracer& pairs(const TriangleList& there);
  /// For `gl10`, with the scene and its hierarchy, whose work is added to `tree`.
  [[nodiscard]] PacketTracer& packets(const Executor& executor, const TriangleList& there,
                                      TreeReport* tree);

 private:
  [[nodiscard]] DeviceQueries& engine(const Executor& executor);

  const FlatScene& scene_;
  const DeviceBackend& backend_;
  template <class T>
  struct Kept {
    std::unique_ptr<T> made;
    bool knows = false;  ///< whether it has the scene
  };
  Kept<PairTracer> pairs_;
  Kept<PacketTracer> packets_;
  Kept<DeviceQueries> engine_;
  bool same_triangles_ = false;  ///< those of the engine, only moved
};

}  // namespace raysheaf
