// Ray queries on a device: what queries/planned_queries.h is on the CPU. The same hits, bit for
// bit.
//
//   triangles ─► upload ─► tree along a curve (object_tree/linear_tree.h): built, refitted or kept
//   ─┐ rays ─► [upload] ─► keys ─► sort ─► each ray down the tree ◄───────────────────────────────┘
//                                          └─► hits in the caller's order
//
// Rays and results may lie in the host's memory or in the device's.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "exec/stage_clock.h"
#include "queries/query_report.h"

namespace raysheaf {

/// What the hits of a run of triangles are called.
struct RunName {
  std::uint32_t first = 0;  ///< the number of its first triangle
  std::uint32_t geom_id = 0, inst_id = 0;
};

/// All hits by ray, each row by (t, triangle): those of ray i are hits[offsets[i]] to before
/// hits[offsets[i + 1]].
struct DeviceHitRows {
  std::vector<std::uint64_t> offsets;
  std::vector<IndexedHit> hits;

  /// As `FoundRows` has it.
  template <class Body>
  void for_each(const Executor& executor, const Body& body) const {
    executor.for_each(offsets.size() - 1, 1024, [&](std::size_t ray) {
      body(ray,
           View<const IndexedHit>(hits.data() + offsets[ray], offsets[ray + 1] - offsets[ray]));
    });
  }
};

struct DeviceQuery {
  Facing facing = Facing::kBoth;
  bool brute = false;  ///< every ray with every triangle
  bool check = false;  ///< refuse rays that are wrong
  bool count = false;  ///< fill the counts of `report`
  /// Rays of one place in the caller's order look along one way, as the camera's and those from one
  /// light do, pixel by pixel: they are not sorted.
  bool in_order = false;
  void* stream = nullptr;  ///< what was asked for on it comes first; null: on the default one
  void* results_stream = nullptr;  ///< and on this, where it is not null
  QueryReport* report = nullptr;
  const Executor* executor = nullptr;  ///< copies large arrays of the host's; null: the caller does
  /// Of closest and any hits: takes the tests of each ray. May be empty; in the device's memory it
  /// is not for brute force, of which the tests are known.
  View<float> ray_tests;
};

/// One scene's, on one device. Not for use by two threads at once. Results are there on return.
/// Throws Error: kOutOfMemory, kInternal with the device's words and the stage's name; kInvalidData
/// for a ray that is refused. What was asked for before and after is not affected.
class DeviceQueries {
 public:
  virtual ~DeviceQueries() = default;

  /// The triangles that there are from now on; they are copied. `same_triangles`: as many, with the
  /// same indices, only moved since the last call, so that the tree may be refitted.
  virtual void set_triangles(const Executor& executor, const TriangleSource& source,
                             bool same_triangles) = 0;
  /// The names of their runs, by ascending `first`: for hits that are asked for as `Hit`.
  virtual void set_names(View<const RunName> names) = 0;

  /// As those of `PlannedQueries`.
  virtual void closest_hit(View<const Ray> rays, const DeviceQuery& query,
                           View<IndexedHit> hits) = 0;
  virtual void closest_hit(View<const Ray> rays, const DeviceQuery& query, View<Hit> hits) = 0;
  virtual void any_hit(View<const Ray> rays, const DeviceQuery& query,
                       View<std::uint8_t> occluded) = 0;
  virtual void count_hits(View<const Ray> rays, const DeviceQuery& query,
                          View<std::uint32_t> counts) = 0;
  [[nodiscard]] virtual DeviceHitRows all_hits(View<const Ray> rays, const DeviceQuery& query) = 0;

  /// Measured by one clock of the device's, gaps between stages included: from the keys of rays to
  /// their hits (`any`: of any hit, else the closest), where rays, tree and hits lie there. Nothing
  /// is reported.
  [[nodiscard]] virtual double keys_to_hits_ms(View<const Ray> rays, const DeviceQuery& query,
                                               bool any) = 0;

  /// Stages of the last query that had a report, in order.
  [[nodiscard]] virtual const std::vector<StageTime>& stage_times() const = 0;
  /// Of the device's memory.
  [[nodiscard]] virtual std::size_t memory_bytes() const = 0;
};

}  // namespace raysheaf
