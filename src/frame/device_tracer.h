// The renderer's batches on a device: a DeviceEngine (engine/device_engine.h), a PairTracer
// (engine/pair_tracer.h) or a PacketTracer (engine/packet_tracer.h) on a flat scene.
#pragma once

#include <memory>
#include <vector>

#include "engine/device_engine.h"
#include "engine/packet_tracer.h"
#include "engine/pair_tracer.h"
#include "raygen/raygen.h"
#include "raysheaf/statistics.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// One scene's, for any number of batches: the triangles are copied to the device once until they
/// are forgotten, and its tree is built by the first batch that needs it.
class DeviceTracer {
 public:
  /// Both must outlive it. Nothing is copied before a batch needs it.
  DeviceTracer(const FlatScene& scene, const DeviceBackend& backend)
      : scene_(scene), backend_(backend) {}

  /// The scene's triangles are others, or elsewhere; `same_triangles`: elsewhere alone.
  void forget_scene(bool same_triangles) {
    pairs_.knows = packets_.knows = engine_.knows = false;
    same_triangles_ = same_triangles_ && same_triangles;
  }

  /// As `DualTracer::trace`, or by brute force.
  [[nodiscard]] std::vector<RayHit> trace(const Executor& executor, const RayBatch& batch,
                                          Facing facing, bool brute, BatchStatistics* statistics,
                                          View<float> ray_tests);

  /// By `rah` or `crsh`, as `query` says; `by_key`: sorted by the batch's keys before.
  [[nodiscard]] std::vector<RayHit> trace_pairs(const Executor& executor, const RayBatch& batch,
                                                PairQuery query, bool by_key, PairOutcome* outcome);

  /// The same by `gl10`.
  [[nodiscard]] std::vector<RayHit> trace_packets(const Executor& executor, const Bvh& bvh,
                                                  const RayBatch& batch, PacketQuery query,
                                                  bool by_key, PacketOutcome* outcome);

  /// Of `rah` and `crsh`, with the scene.
  [[nodiscard]] PairTracer& pairs(const Executor& executor);
  /// Of `gl10`, with the scene; `bvh`: its hierarchy.
  [[nodiscard]] PacketTracer& packets(const Executor& executor, const Bvh& bvh);

 private:
  template <class Tracer, class Query, class Outcome>
  [[nodiscard]] std::vector<RayHit> trace_by(Tracer& tracer, const Executor& executor,
                                             const RayBatch& batch, Query query, bool by_key,
                                             Outcome* outcome);
  [[nodiscard]] DeviceEngine& engine(const Executor& executor);
  [[nodiscard]] Buffer<Vec3> corners(const Executor& executor) const;

  const FlatScene& scene_;
  const DeviceBackend& backend_;
  template <class T>
  struct Kept {
    std::unique_ptr<T> made;
    bool knows = false;  ///< the scene
  };
  Kept<PairTracer> pairs_;
  Kept<PacketTracer> packets_;
  Kept<DeviceEngine> engine_;
  bool same_triangles_ = false;  ///< as the engine has
  Buffer<EngineHit> closest_;
  Buffer<std::uint8_t> occluded_;
};

}  // namespace raysheaf
