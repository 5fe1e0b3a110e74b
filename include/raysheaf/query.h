// Batches of rays against a committed scene (raysheaf/scene.h).
//
// Rays may come in any order, and mixed; results stand at their ray's place. Large batches pay:
// rays are answered together, so one call with 100 000 of them is far faster than 100 000 calls.
// The answers depend on rays and triangles alone, bit for bit: not on threads, SIMD, method, the
// order of the batch, nor on what the scene was before.
//
// All functions throw `Error`: kInvalidData naming the first ray that is wrong, kInvalidArgument
// for spans of unequal length, kWrongState where the scene has changes that were not committed or
// is being changed by another thread, kCancelled, kOutOfMemory. Results are then unspecified.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "raysheaf/error.h"  // IWYU pragma: export
#include "raysheaf/large_vector.h"
#include "raysheaf/ray_parts.h"
#include "raysheaf/scene.h"
#include "raysheaf/types.h"

namespace raysheaf {

enum class QueryMethod : std::uint8_t {
  kDual,   ///< bundles of rays against a hierarchy over the triangles
  kBrute,  ///< every ray with every triangle: to check against
};

/// What a query did. Counts are the same with any number of threads.
struct QueryStatistics {
  std::uint64_t rays = 0;
  std::uint64_t triangles = 0;  ///< that the query's mask shows, counted once an instance
  // Filled where `QueryOptions::count_tests` says so.
  std::uint64_t bound_tests = 0;      ///< a bundle of rays with a box or a triangle
  std::uint64_t ray_bound_tests = 0;  ///< a ray with a box
  std::uint64_t triangle_tests = 0;   ///< a ray with a triangle
  // Milliseconds.
  double update_ms = 0;     ///< what changed the scene before its last commit, and that commit
  double check_ms = 0;      ///< looking the rays over, packing those that come in parts, and, where
                            ///< they go in long streams (docs/dual.md), putting them by quarter
  double order_ms = 0;      ///< the order of the rays else: quarters, or keys and a sort
  double hierarchy_ms = 0;  ///< over the triangles, where they have changed, and over the rays
  double trace_ms = 0;      ///< bringing the two together
  double total_ms = 0;      ///< the whole call, with writing results and what is not above; where
                            ///< threads take batches piece by piece, stages share their time
  std::vector<std::string> plan;  ///< what was chosen and why: a sentence a choice

  [[nodiscard]] std::uint64_t tests() const {
    return bound_tests + ray_bound_tests + triangle_tests;
  }
};

struct QueryOptions {
  QueryMethod method = QueryMethod::kDual;
  /// Instances are seen where (their mask & this) != 0.
  std::uint32_t mask = 0xffffffff;
  /// Refuse rays that are wrong: origins or directions that are not finite, directions of length
  /// zero, `t_min` negative, `t_min` > `t_max`, NaN anywhere. Without, the caller vouches for them:
  /// a wrong ray makes the results of its whole batch unspecified.
  bool check = true;
  bool count_tests = false;  ///< for `statistics`; costs a little
  /// With Device::kCuda, rays and results may lie in the device's memory, and what was asked for on
  /// this stream (a cudaStream_t; null: the default one) comes before the query. Results are there
  /// when it returns. Not used otherwise.
  void* stream = nullptr;
  /// A second one that comes first, where results were last used on another than rays. Null: none.
  void* results_stream = nullptr;
  /// Set by another thread (or a handler of signals), the query throws `Error` (kCancelled) within
  /// some milliseconds, and the scene answers the next. A device's queries look at it only before
  /// they begin.
  const std::atomic<bool>* stop = nullptr;
  QueryStatistics* statistics = nullptr;  ///< written where it is not null
};

/// hits[i] is the hit of rays[i] with the least (t, geom_id, inst_id, prim_id), or `Hit{}` for
/// none. Spans of equal length.
void closest_hit(const Scene& scene, std::span<const Ray> rays, std::span<Hit> hits,
                 const QueryOptions& options = {});
void closest_hit(const Scene& scene, const RayParts& rays, std::span<Hit> hits,
                 const QueryOptions& options = {});
[[nodiscard]] std::vector<Hit> closest_hit(const Scene& scene, std::span<const Ray> rays,
                                           const QueryOptions& options = {});

/// occluded[i] is 1 where rays[i] meets anything in [t_min, t_max], else 0. Spans of equal length.
void any_hit(const Scene& scene, std::span<const Ray> rays, std::span<std::uint8_t> occluded,
             const QueryOptions& options = {});
void any_hit(const Scene& scene, const RayParts& rays, std::span<std::uint8_t> occluded,
             const QueryOptions& options = {});
[[nodiscard]] std::vector<std::uint8_t> any_hit(const Scene& scene, std::span<const Ray> rays,
                                                const QueryOptions& options = {});

/// Compressed rows: the hits of ray i are hits[offsets[i]] to before hits[offsets[i + 1]]. The
/// memory of rows that are gone is kept for those to come until a scene goes: at most as much as
/// was in use at once.
struct HitRows {
  LargeVector<std::uint64_t> offsets;  ///< one more than rays; the first is 0
  LargeVector<Hit> hits;

  [[nodiscard]] std::size_t size() const { return offsets.empty() ? 0 : offsets.size() - 1; }
  [[nodiscard]] std::span<const Hit> operator[](std::size_t ray) const {
    return std::span(hits).subspan(offsets[ray], offsets[ray + 1] - offsets[ray]);
  }
};

/// Every hit of every ray, each row sorted by (t, geom_id, inst_id, prim_id). A ray through an edge
/// or a vertex meets all triangles that share it.
[[nodiscard]] HitRows all_hits(const Scene& scene, std::span<const Ray> rays,
                               const QueryOptions& options = {});
[[nodiscard]] HitRows all_hits(const Scene& scene, const RayParts& rays,
                               const QueryOptions& options = {});

/// counts[i] is the number of hits of rays[i]: the length of its row in `all_hits`. Spans of equal
/// length.
void hit_counts(const Scene& scene, std::span<const Ray> rays, std::span<std::uint32_t> counts,
                const QueryOptions& options = {});
void hit_counts(const Scene& scene, const RayParts& rays, std::span<std::uint32_t> counts,
                const QueryOptions& options = {});
[[nodiscard]] std::vector<std::uint32_t> hit_counts(const Scene& scene, std::span<const Ray> rays,
                                                    const QueryOptions& options = {});

}  // namespace raysheaf
