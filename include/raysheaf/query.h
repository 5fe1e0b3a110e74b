// Batches of rays against a committed scene (raysheaf/scene.h).
//
// Rays may come in any order; each result has the index of its ray. Large batches pay: rays are
// answered together, so one call with 100 000 rays is far faster than 100 000 calls. A program that
// has one ray at a time may pass that ray. The answers depend only on rays and triangles, bit for
// bit: not on threads, SIMD, the method, the order of the batch, or earlier states of the scene.
//
// All functions throw `Error`: kInvalidData naming the first invalid ray, kInvalidArgument for
// spans of unequal length, kWrongState if the scene has uncommitted changes or another thread is
// changing it, kCancelled, kOutOfMemory. Results are then unspecified.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "raysheaf/error.h"  // IWYU pragma: export
#include "raysheaf/large_vector.h"
#include "raysheaf/scene.h"
#include "raysheaf/types.h"

namespace raysheaf {

enum class QueryMethod : std::uint8_t {
  kDual,   ///< bundles of rays against a hierarchy over the triangles
  kBrute,  ///< every ray with every triangle: the reference for checks
};

/// Counts and times of a query. Counts are the same with any number of threads.
struct QueryStatistics {
  std::uint64_t rays = 0;
  std::uint64_t triangles = 0;  ///< visible to the query's mask, counted for each instance
  // Counted only with `QueryOptions::count_tests`.
  std::uint64_t bound_tests = 0;      ///< tests of a bundle of rays with a box
  std::uint64_t ray_bound_tests = 0;  ///< tests of a ray with a box
  std::uint64_t triangle_tests = 0;   ///< tests of a ray with a triangle
  // Milliseconds.
  double update_ms = 0;  ///< the changes before the last commit, and that commit
  /// Validating rays, packing rays in parts, and sorting rays of long streams (docs/dual.md) by
  /// quarter.
  double check_ms = 0;
  double order_ms = 0;      ///< ordering all other rays: by quarter, or by keys
  double hierarchy_ms = 0;  ///< building or refitting hierarchies over triangles and rays
  double trace_ms = 0;      ///< traversal and intersection
  /// The whole call, including results and everything not listed above; if threads take batches
  /// tile by tile, stages share their time.
  double total_ms = 0;
  std::vector<std::string> plan;  ///< the choices of the plan and their reasons, a sentence each

  [[nodiscard]] std::uint64_t tests() const {
    return bound_tests + ray_bound_tests + triangle_tests;
  }
};

struct QueryOptions {
  QueryMethod method = QueryMethod::kDual;
  /// The query sees an instance if (the instance's mask & this) != 0.
  std::uint32_t mask = 0xffffffff;
  /// Validate rays, and refuse origins or directions that are not finite, directions of length
  /// zero, `t_min` negative, `t_min` > `t_max`, NaN anywhere. Without validation, an invalid ray
  /// makes the results of its whole batch unspecified.
  bool check = true;
  bool count_tests = false;  ///< for `statistics`; has a small cost
  /// With Device::kCuda, rays and results may reside in the device's memory. The query waits for
  /// the work queued on this stream (a cudaStream_t; null: the default one); results are complete
  /// when it returns. Not used otherwise.
  void* stream = nullptr;
  /// Optional second stream to wait for, if the result buffer was last used on a different stream
  /// than the rays. Null: none.
  void* results_stream = nullptr;
  /// If another thread or a signal handler sets this flag, the query throws `Error` (kCancelled)
  /// within milliseconds, and the scene answers the next query normally. Queries on a device read
  /// the flag only before they begin.
  const std::atomic<bool>* stop = nullptr;
  QueryStatistics* statistics = nullptr;  ///< written unless null

  // With any of the six below, a batch is not divided into tiles. Their spans are in the host's
  // memory. With worlds or times the CPU's threads answer on Device::kCuda: rays and results must
  // be in the host's memory, or the query throws kUnsupported.

  /// The sides of triangles that rays meet; the others are passed through.
  Sides sides = Sides::kBoth;
  /// Empty, or one a ray: rays[i] sees an instance if (its mask & `mask` & ray_masks[i]) != 0.
  std::span<const std::uint32_t> ray_masks{};
  /// Empty, or one a ray: rays[i] does not meet the triangle skip[i], mostly the one that it starts
  /// from. Ids that the scene does not have name no triangle.
  std::span<const TriangleId> skip{};
  /// Empty, or one a ray: the world that rays[i] is in (`Scene::instance`), or `kAllWorlds`.
  /// Without worlds rays see the instances of all.
  std::span<const WorldId> ray_worlds{};
  /// Unless 0, and instead of `ray_worlds`: with n of this, rays[w * n] up to, excluding,
  /// rays[(w + 1) * n] are in world w. The number of rays must be a multiple of it.
  std::size_t rays_per_world = 0;
  /// Empty, or one a ray, from 0 to 1: rays[i] meets each instance where it is at that time
  /// (`transform_at`), with the vertices that its mesh has then (`Scene::positions_at`); without
  /// times, at 0. The answer is that of a scene with these transforms and vertices.
  std::span<const float> ray_times{};
};

/// The triangle of a hit, for `QueryOptions::skip`.
[[nodiscard]] inline TriangleId triangle_of(const Hit& hit) {
  return {hit.inst_id, hit.prim_id};
}

/// hits[i] is the hit of rays[i] with the least (t, geom_id, inst_id, prim_id), or `Hit{}` for
/// none. Spans of equal length.
void closest_hit(const Scene& scene, const RayParts& rays, std::span<Hit> hits,
                 const QueryOptions& options = {});
[[nodiscard]] std::vector<Hit> closest_hit(const Scene& scene, const RayParts& rays,
                                           const QueryOptions& options = {});

/// occluded[i] is 1 if rays[i] hits anything in [t_min, t_max], else 0. Spans of equal length.
void any_hit(const Scene& scene, const RayParts& rays, std::span<std::uint8_t> occluded,
             const QueryOptions& options = {});
[[nodiscard]] std::vector<std::uint8_t> any_hit(const Scene& scene, const RayParts& rays,
                                                const QueryOptions& options = {});

/// The answer of a batch of this one ray, to which the options apply. It is in the host's memory.
/// Nothing is allocated, and the threads of the context are not needed, where a batch of few rays
/// needs neither (docs/library.md, "One ray"). Errors about the ray have the place "ray.direction".
[[nodiscard]] Hit closest_hit(const Scene& scene, const Ray& ray, const QueryOptions& options = {});
[[nodiscard]] bool any_hit(const Scene& scene, const Ray& ray, const QueryOptions& options = {});

/// Compressed rows: the hits of ray i are hits[offsets[i]] up to, excluding, hits[offsets[i + 1]].
/// Memory of destroyed rows is reused for later ones until a scene is destroyed; it never exceeds
/// the most that was in use at one time.
struct HitRows {
  LargeVector<std::uint64_t> offsets;  ///< one more than rays; the first is 0
  LargeVector<Hit> hits;

  [[nodiscard]] std::size_t size() const { return offsets.empty() ? 0 : offsets.size() - 1; }
  [[nodiscard]] std::span<const Hit> operator[](std::size_t ray) const {
    return std::span(hits).subspan(offsets[ray], offsets[ray + 1] - offsets[ray]);
  }
};

/// Every hit of every ray, each row sorted by (t, geom_id, inst_id, prim_id). A ray through an edge
/// or a vertex hits all triangles that share it.
[[nodiscard]] HitRows all_hits(const Scene& scene, const RayParts& rays,
                               const QueryOptions& options = {});

/// The first `most` hits of each row of `all_hits`. Takes the time of `all_hits`.
[[nodiscard]] HitRows first_hits(const Scene& scene, const RayParts& rays, std::uint32_t most,
                                 const QueryOptions& options = {});

/// counts[i] is the number of hits of rays[i]: the length of its row in `all_hits`. Spans of equal
/// length.
void hit_counts(const Scene& scene, const RayParts& rays, std::span<std::uint32_t> counts,
                const QueryOptions& options = {});
[[nodiscard]] std::vector<std::uint32_t> hit_counts(const Scene& scene, const RayParts& rays,
                                                    const QueryOptions& options = {});

}  // namespace raysheaf
