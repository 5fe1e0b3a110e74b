// Method `dual` for the renderer's batches: the engine (queries/planned_queries.h) on a flat scene.
//
// What asks only whether a ray meets anything is answered by any-hit queries, and the rays of each
// light by one of their own: those of a point light share their origin, which the engine knows how
// to use.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "base/buffer.h"
#include "queries/planned_queries.h"
#include "rays/raygen.h"
#include "raysheaf/statistics.h"
#include "scene/flat_update.h"

namespace raysheaf {

/// The triangle of a hit that any-hit queries found: they do not say which. No scene has as many.
inline constexpr std::uint32_t kSomeTriangle = kInvalidId - 1;

/// Whether of such rays only matters if they meet something.
[[nodiscard]] constexpr bool asks_occlusion(RayKind kind) {
  return kind == RayKind::kShadow || kind == RayKind::kAmbientOcclusion;
}

[[nodiscard]] inline bool asks_occlusion(const RayBatch& batch) {
  return asks_occlusion(batch.kind) && !batch.names_hits;
}

/// What a frame asks its engine for beside hits.
[[nodiscard]] inline PlannedOptions counting_options(Facing facing) {
  return {facing, true};
}

/// What a frame did with the hierarchy over its triangles.
struct TreeReport {
  bool used = false;
  TreeWork work = TreeWork::kKeep;  ///< the most that any batch asked for
  double ms = 0;

  void add(const TreeReport& other) {
    used = used || other.used;
    work = std::max(work, other.work);
    ms += other.ms;
  }
};

/// One scene's, for any number of batches: the object tree is built by the first that needs it.
/// About 36 bytes a triangle beside the engine's, and 17 a ray of the largest batch.
class DualTracer {
 public:
  /// O(triangles). `scene` must outlive it.
  DualTracer(const Executor& executor, const FlatScene& scene);
  /// The scene changed as `update` says: the tree is refitted where the same triangles have moved,
  /// and only there.
  /// O(what was placed), or O(triangles) where they are others. Nothing is built before a batch
  /// needs it.
  void update(const Executor& executor, const FlatScene& scene, const FlatUpdate& update);
  /// Brings the object tree up to date, for `TreeQueries` of several threads
  /// (queries/planned_queries.h). Returns what it took and why.
  QueryReport prepare_tree(const Executor& executor);
  [[nodiscard]] PlannedQueries& engine() { return engine_; }
  DualTracer(const DualTracer&) = delete;
  DualTracer& operator=(const DualTracer&) = delete;

  /// The hits of a batch, in its order; `kSomeTriangle` at t = 0 for rays that ask for occlusion.
  /// Adds counts, times and the plan to `statistics`, and each ray's tests to `ray_tests` unless
  /// that is empty.
  [[nodiscard]] std::vector<RayHit> trace(const Executor& executor, const RayBatch& batch,
                                          Facing facing, BatchStatistics* statistics,
                                          View<float> ray_tests);

  /// Of all batches since the last call.
  [[nodiscard]] TreeReport take_tree_report() { return std::exchange(tree_, {}); }

 private:
  void copy_corners(const Executor& executor, const FlatScene& scene, std::size_t first,
                    std::size_t count);
  void add_report(const QueryReport& report, std::size_t rays, bool whole,
                  BatchStatistics* statistics);
  /// All of `corners_`.
  [[nodiscard]] TriangleSource source_of(const FlatScene& scene);
  /// occluded[i] = 1 where ray i of a batch meets anything, else 0.
  void find_occluded(const Executor& executor, const RayBatch& batch, Facing facing,
                     BatchStatistics* statistics, View<float> ray_tests,
                     View<std::uint8_t> occluded);
  void find_closest(const Executor& executor, const RayBatch& batch, const PlannedOptions& options,
                    BatchStatistics* statistics, View<float> ray_tests, View<RayHit> hits);

  Buffer<Vec3> corners_;  ///< three a triangle
  TriangleRun run_;       ///< all of them
  PlannedQueries engine_;
  TreeReport tree_;
  Buffer<IndexedHit> closest_;
  Buffer<std::uint8_t> occluded_;
};

/// The places where one any-hit query ends and the next begins, from 0 to the number of rays: rays
/// of one light that start at one point have a query of their own; neighbours among all others
/// share theirs.
[[nodiscard]] std::vector<std::size_t> query_ends(const RayBatch& batch);

}  // namespace raysheaf
