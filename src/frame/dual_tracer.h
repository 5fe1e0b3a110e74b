// Method `dual` for the renderer's batches: the engine (engine/engine.h) on a flat scene.
//
// What asks only whether a ray meets anything is answered by any-hit queries, and the rays of each
// light by one of their own: those of a point light share their origin, which the engine knows how
// to use.
#pragma once

#include <vector>

#include "base/buffer.h"
#include "engine/engine.h"
#include "raygen/raygen.h"
#include "raysheaf/statistics.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// The triangle of a hit that any-hit queries found: they do not say which. No scene has as many.
inline constexpr std::uint32_t kSomeTriangle = kInvalidId - 1;

/// Whether of such rays only matters if they meet something.
[[nodiscard]] constexpr bool asks_occlusion(RayKind kind) {
  return kind == RayKind::kShadow || kind == RayKind::kAmbientOcclusion;
}

/// One scene's, for any number of batches: the object tree is built by the first that needs it.
/// About 36 bytes a triangle beside the engine's, and 17 a ray of the largest batch.
class DualTracer {
 public:
  /// O(triangles). `scene` must outlive it.
  DualTracer(const Executor& executor, const FlatScene& scene);
  DualTracer(const DualTracer&) = delete;
  DualTracer& operator=(const DualTracer&) = delete;

  /// The hits of a batch, in its order; `kSomeTriangle` at t = 0 for rays that ask for occlusion.
  /// Adds counts, times and the plan to `statistics`, and each ray's tests to `ray_tests` unless
  /// that is empty.
  [[nodiscard]] std::vector<RayHit> trace(const Executor& executor, const RayBatch& batch,
                                          Facing facing, BatchStatistics* statistics,
                                          View<float> ray_tests);

 private:
  void find_occluded(const Executor& executor, const RayBatch& batch, const EngineOptions& options,
                     BatchStatistics* statistics, View<float> ray_tests, View<RayHit> hits);
  void find_closest(const Executor& executor, const RayBatch& batch, const EngineOptions& options,
                    BatchStatistics* statistics, View<float> ray_tests, View<RayHit> hits);

  Buffer<Vec3> corners_;  ///< three a triangle
  TriangleRun run_;       ///< all of them
  Engine engine_;
  Buffer<EngineHit> closest_;
  Buffer<std::uint8_t> occluded_;
};

/// The places where one any-hit query ends and the next begins, from 0 to the number of rays: rays
/// of one light that start at one point have a query of their own; neighbours among all others
/// share theirs.
[[nodiscard]] std::vector<std::size_t> query_ends(const RayBatch& batch);

}  // namespace raysheaf
