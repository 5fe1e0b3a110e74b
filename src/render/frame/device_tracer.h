// A flat scene on a device: the tracers of the methods that order rays
// (methods/ray_hierarchy/pair_tracer.h, methods/packets/packet_tracer.h), which frames of theirs
// use there, and a DeviceQueries for rays that the host asks for before a frame begins.
#pragma once

#include <memory>
#include <vector>

#include "device/backend.h"
#include "device/device_queries.h"
#include "methods/packets/packet_tracer.h"
#include "methods/ray_hierarchy/pair_tracer.h"
#include "rays/raygen.h"
#include "raysheaf/statistics.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// One scene's, until it is forgotten.
class DeviceTracer {
 public:
  /// Both must outlive it. Nothing is copied before it is needed.
  DeviceTracer(const FlatScene& scene, const DeviceBackend& backend)
      : scene_(scene), backend_(backend) {}

  /// The scene's triangles are others, or elsewhere; `same_triangles`: elsewhere alone.
  void forget_scene(bool same_triangles) {
    pairs_.knows = packets_.knows = engine_.knows = false;
    same_triangles_ = same_triangles_ && same_triangles;
  }

  /// The closest hits of a few rays that the host asks for, whatever the method of the frame.
  [[nodiscard]] std::vector<RayHit> trace(const Executor& executor, const RayBatch& batch,
                                          Facing facing);

  /// Of `rah` and `crsh`, with the scene, whose triangles lie there until they are forgotten.
  [[nodiscard]] PairTracer& pairs(const TriangleList& there);
  /// Of `gl10`, with the scene; `bvh`: its hierarchy.
  [[nodiscard]] PacketTracer& packets(const TriangleList& there, const Bvh& bvh);

 private:
  [[nodiscard]] DeviceQueries& engine(const Executor& executor);

  const FlatScene& scene_;
  const DeviceBackend& backend_;
  template <class T>
  struct Kept {
    std::unique_ptr<T> made;
    bool knows = false;  ///< the scene
  };
  Kept<PairTracer> pairs_;
  Kept<PacketTracer> packets_;
  Kept<DeviceQueries> engine_;
  bool same_triangles_ = false;  ///< as the engine has
};

}  // namespace raysheaf
