// Queries of rays and points on a device: the counterpart of queries/planned_queries.h and
// nearest/nearest.h. Its answers are the same, bit for bit.
//
//   triangles ─► upload ─► tree along a curve (object_tree/linear_tree.h): built, refitted or kept
//   ─┐ rays ─► [upload] ─► keys ─► sort ─► each ray down the tree ◄───────────────────────────────┘
//                                          └─► hits in the caller's order
//
// Rays, points and results may be in the host's or in the device's memory.
#pragma once

#include <concepts>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "exec/stage_clock.h"
#include "intersect/hit_filter.h"
#include "levels/level_scene.h"
#include "nearest/point.h"
#include "queries/query_report.h"
#include "raysheaf/points.h"
#include "raysheaf/types.h"
#include "scene/placed_runs.h"

namespace raysheaf {

/// The ids for hits of a run of triangles.
struct RunName {
  std::uint32_t first = 0;  ///< the number of its first triangle
  std::uint32_t geom_id = 0, inst_id = 0;
};

/// All hits by ray, each row sorted by (t, triangle): those of ray i are hits[offsets[i]] up to,
/// excluding, hits[offsets[i + 1]].
template <class Found>
struct DeviceRows {
  std::vector<std::uint64_t> offsets;
  std::vector<Found> hits;

  /// As `FoundRows::for_each`.
  template <class Body>
  void for_each(const Executor& executor, const Body& body) const {
    executor.for_each(offsets.size() - 1, 1024, [&](std::size_t ray) {
      body(ray, View<const Found>(hits.data() + offsets[ray], offsets[ray + 1] - offsets[ray]));
    });
  }
};
using DeviceHitRows = DeviceRows<IndexedHit>;

struct DeviceQuery {
  Facing facing = Facing::kBoth;
  bool brute = false;   ///< every ray or point with every triangle
  bool enters = false;  ///< rays meet the instances of `set_instances` where they stand
  /// Where rays enter, only its `choice` counts; among placed triangles it selects hits if it has
  /// runs, which are those of the triangles. Worlds are not looked at.
  HitFilter filter;
  bool check = false;  ///< refuse invalid rays
  bool count = false;  ///< fill the counts of `report`
  /// Rays are in the caller's order with coherent directions, as primary rays and those of one
  /// light are, pixel by pixel: they are not sorted.
  bool in_order = false;
  void* stream = nullptr;  ///< the query waits for the work queued on it; null: the default one
  void* results_stream = nullptr;  ///< a second stream to wait for, unless null
  QueryReport* report = nullptr;
  bool explain = true;                 ///< adds to the report's plan
  const Executor* executor = nullptr;  ///< copies large arrays of the host; null: the caller does
  InsideRule rule = InsideRule::kNonZero;  ///< of points
  bool closed = false;  ///< all rays from a point agree on the rule (nearest/inside.h)
  /// For closest and any hits: receives the number of tests of each ray. May be empty. If it is in
  /// the device's memory, brute force does not fill it, because every ray then tests all triangles.
  View<float> ray_tests;
};

/// The points of a query: packed and validated in the host's memory, or as rows of numbers in the
/// device's, where they are packed.
struct DevicePoints {
  std::size_t count = 0;
  View<const QueryPoint> packed;  ///< the host's; empty: `rows`
  NumberRows rows;                ///< the device's
  NumberRows radii;               ///< the same, of `rows`; without data: `radius`
  double radius = std::numeric_limits<double>::infinity();
  bool check = true;      ///< refuse invalid rows
  std::size_t first = 0;  ///< the number of the first point in errors

  DevicePoints() = default;
  /// A list of packed points.
  template <class List>
  requires std::convertible_to<const List&, View<const QueryPoint>> DevicePoints(
      const List& list)  // NOLINT: a view
      : packed(list) {
    count = packed.size;
  }
};

/// The engine of one scene on one device. Not for two threads at once. Results are complete on
/// return. Throws Error: kOutOfMemory, kInternal with the device's message and the stage's name;
/// kInvalidData for an invalid ray or point. Earlier and later queries are not affected.
class DeviceQueries {
 public:
  virtual ~DeviceQueries() = default;

  /// Sets the triangles, which are copied. `same_triangles`: as many, with the same indices, only
  /// moved since the last call, so that the tree may be refitted.
  virtual void set_triangles(const Executor& executor, const TriangleSource& source,
                             bool same_triangles) = 0;
  /// Sets the ids of the runs, by ascending `first`, for queries that return `Hit`.
  virtual void set_names(View<const RunName> names) = 0;

  /// Sets instances that rays may enter where they stand; `marks` has one for each. Only what has
  /// changed since the last call is copied: a mesh by its `shape`, and where instances only move
  /// their transforms. Returns the least `inst_id` of those that rays cannot enter (scene/
  /// placing.h), and no query may `enter` then, or kInvalidId. Waits.
  virtual InstanceId set_instances(const Executor& executor, View<const PlacedInstance> instances,
                                   View<const LevelMark> marks) = 0;
  /// The triangles of meshes that `set_instances` would have to copy.
  [[nodiscard]] virtual std::uint64_t missing_triangles(
      View<const PlacedInstance> instances) const = 0;

  /// As those of `PlannedQueries`. Only queries for `Hit`, any hits and numbers of hits may `enter`
  /// instances.
  virtual void closest_hit(View<const Ray> rays, const DeviceQuery& query,
                           View<IndexedHit> hits) = 0;
  virtual void closest_hit(View<const Ray> rays, const DeviceQuery& query, View<Hit> hits) = 0;
  virtual void any_hit(View<const Ray> rays, const DeviceQuery& query,
                       View<std::uint8_t> occluded) = 0;
  virtual void count_hits(View<const Ray> rays, const DeviceQuery& query,
                          View<std::uint32_t> counts) = 0;
  [[nodiscard]] virtual DeviceHitRows all_hits(View<const Ray> rays, const DeviceQuery& query) = 0;
  /// The same for a query that enters instances.
  [[nodiscard]] virtual DeviceRows<Hit> all_entered_hits(View<const Ray> rays,
                                                         const DeviceQuery& query) = 0;

  /// The `k` nearest triangles of each point, as raysheaf/points.h has them; k results a point.
  virtual void nearest(const DevicePoints& points, std::uint32_t k, const DeviceQuery& query,
                       View<ClosestPoint> found) = 0;
  virtual void signed_distance(const DevicePoints& points, const DeviceQuery& query,
                               View<double> distances) = 0;
  virtual void contains(const DevicePoints& points, const DeviceQuery& query,
                        View<std::uint8_t> inside) = 0;

  /// The time by a clock of the device, including gaps between stages, from the keys of rays to
  /// their hits (`any`: any hit, else the closest). Rays, tree and hits must be resident on the
  /// device. Fills no report.
  [[nodiscard]] virtual double keys_to_hits_ms(View<const Ray> rays, const DeviceQuery& query,
                                               bool any) = 0;

  /// The stages of the last query that had a report, in order.
  [[nodiscard]] virtual const std::vector<StageTime>& stage_times() const = 0;
  /// The device's memory in use.
  [[nodiscard]] virtual std::size_t memory_bytes() const = 0;
};

}  // namespace raysheaf
