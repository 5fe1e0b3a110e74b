// The method `dual` for the renderer's batches: the engine (queries/planned_queries.h) on a flat
// scene.
//
// Occlusion rays use any-hit queries, a separate one for each light: the rays of a point light
// share their origin, which the engine exploits.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "base/buffer.h"
#include "queries/planned_queries.h"
#include "raysheaf/statistics.h"
#include "render/rays/raygen.h"
#include "scene/flat_update.h"

namespace raysheaf {

/// The triangle of an any-hit result, which does not name one. No scene has this many triangles.
inline constexpr std::uint32_t kSomeTriangle = kInvalidId - 1;

/// Whether only occlusion matters for these rays.
[[nodiscard]] inline bool asks_occlusion(const RayBatch& batch) {
  return entry_of(batch.kind).any_hit && !batch.names_hits;
}

/// The options with which a frame also gets counts, the same for every use of its threads.
[[nodiscard]] inline PlannedOptions counting_options(Facing facing, View<float> ray_tests = {}) {
  PlannedOptions options;
  options.facing = facing;
  options.count = options.whole = true;
  options.ray_tests = ray_tests;
  return options;
}

/// The use of the hierarchy over the triangles in a frame.
struct TreeReport {
  bool used = false;
  TreeWork work = TreeWork::kKeep;  ///< the most expensive that any batch requested
  double ms = 0;

  void add(const TreeReport& other) {
    used = used || other.used;
    work = std::max(work, other.work);
    ms += other.ms;
  }
};

/// For one scene and any number of batches: the first batch that needs the object tree builds it.
/// A byte per ray of the largest batch in addition to the engine's.
class DualTracer {
 public:
  /// `scene` must outlive this object.
  explicit DualTracer(const FlatScene& scene) { engine_.set_triangles(scene.source(), false); }
  /// Updates after the scene's change `update`: if the same triangles have moved, the tree is
  /// refitted there only. Builds nothing until a batch needs it.
  void update(const FlatScene& scene, const FlatUpdate& update);
  /// Updates the object tree for `TreeQueries` of several threads (queries/planned_queries.h).
  /// Returns the time and the reasons.
  QueryReport prepare_tree(const Executor& executor);
  [[nodiscard]] PlannedQueries& engine() { return engine_; }
  DualTracer(const DualTracer&) = delete;
  DualTracer& operator=(const DualTracer&) = delete;

  /// The hits of a batch, in its order; `kSomeTriangle` at t = 0 for occlusion rays. Adds counts,
  /// times and the plan to `statistics`, and each ray's tests to `ray_tests` unless that is empty.
  [[nodiscard]] std::vector<RayHit> trace(const Executor& executor, const RayBatch& batch,
                                          Facing facing, BatchStatistics* statistics,
                                          View<float> ray_tests);

  /// For all batches since the last call.
  [[nodiscard]] TreeReport take_tree_report() { return std::exchange(tree_, {}); }

 private:
  void add_report(const QueryReport& report, std::size_t rays, bool whole,
                  BatchStatistics* statistics);
  /// Sets occluded[i] to 1 if ray i of a batch hits anything, else 0.
  void find_occluded(const Executor& executor, const RayBatch& batch, Facing facing,
                     BatchStatistics* statistics, View<float> ray_tests,
                     View<std::uint8_t> occluded);
  void find_closest(const Executor& executor, const RayBatch& batch, const PlannedOptions& options,
                    BatchStatistics* statistics, View<RayHit> hits);

  PlannedQueries engine_;
  TreeReport tree_;
  Buffer<std::uint8_t> occluded_;
};

/// The places where one any-hit query ends and the next begins, from 0 to the number of rays: rays
/// of one light that start at one point have a separate query; among the others, neighbours share
/// one.
[[nodiscard]] std::vector<std::size_t> query_ends(const RayBatch& batch);

}  // namespace raysheaf
