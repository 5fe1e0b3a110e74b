// The method `dual` from end to end: batches of ray queries against triangles that may move between
// any two batches.
//
//   update ─► [plan] ─► order the rays ─► object tree ─► bundles of rays through the tree ─► hits
//
// The plan (queries/plan.h) depends on the batch and the scene, and states its reasons.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "methods/dual/dual.h"
#include "methods/dual/ray_stream.h"
#include "object_tree/fine_build.h"
#include "object_tree/object_tree.h"
#include "queries/plan.h"
#include "queries/quartered_rays.h"
#include "queries/query_report.h"
#include "queries/ray_tiles.h"
#include "scene/triangle_source.h"

namespace raysheaf {

struct PlannedOptions {
  Facing facing = Facing::kBoth;
  bool count = false;  ///< fill the counts of `QueryReport`
  /// By the numbers of the batch's rays; null: all hits count. Such batches are answered whole.
  const HitFilter* filter = nullptr;
  /// Each ray's tests are added here; empty: to none. Such batches are answered whole.
  View<float> ray_tests = {};
  /// All rays go through one stage after the other, not in tiles (queries/ray_tiles.h).
  bool whole = false;
  GivenChoices given = {};  ///< in place of the plan's own choices
  bool ready = false;       ///< `is_ready_for` these rays: nothing is planned
};

/// All hits of a batch, stored until the next query of its `PlannedQueries`.
class FoundRows {
 public:
  FoundRows(const RowLists& lists, View<const std::uint32_t> order)
      : lists_(&lists), order_(order) {}

  /// Calls `body(ray, hits)` for every ray that hits something, and possibly for others, in any
  /// order and from several threads; hits are sorted by (t, triangle). If the body has
  /// `comes_soon(ray)`, it is called ahead of time for prefetching, because rays may be scattered.
  template <class Body>
  void for_each(const Executor& executor, const Body& body) const {
    constexpr std::size_t kSoon = 16;
    executor.for_each(lists_->size(), 1, [&](std::size_t number) {
      const RowList& list = (*lists_)[number];
      for (std::size_t i = 0; i < list.ends.size(); ++i) {
        if constexpr (requires { body.comes_soon(0); }) {
          if (i + kSoon < list.ends.size()) body.comes_soon(order_[list.first + i + kSoon]);
        }
        body(order_[list.first + i], list.row(i));
      }
    });
  }

 private:
  const RowLists* lists_;
  View<const std::uint32_t> order_;
};

/// The engine of one scene: the object tree and its age. Not for two threads at once; several
/// threads may each have their own engine for the same triangles.
class PlannedQueries {
 public:
  /// Sets the triangles. `same_triangles`: as many, with the same indices, only moved, so that the
  /// tree may be refitted. `source` and the arrays to which it points must live until the next
  /// call. Builds nothing; queries build what they need.
  void set_triangles(const TriangleSource& source, bool same_triangles);
  /// The same triangles, of which only the ranges `moved` have moved.
  void move_triangles(const TriangleSource& source, View<const TriangleRange> moved);

  /// Updates the tree to the triangles' positions, as queries do when they need it. Afterwards
  /// threads may query through `TreeQueries` (queries/tree_queries.h). Call none of the members
  /// below until every such thread has called `add_rays`.
  const ObjectTree& prepare_tree(const Executor& executor, QueryReport* report);
  void add_rays(std::uint64_t count);

  /// Whether the tree is as the plan wants it for so many rays, at most kFewTogether, as those
  /// before; if so, they count as traced. Several threads may ask, and then query for closest or
  /// any hits with `PlannedOptions::ready`, as long as none calls anything else.
  [[nodiscard]] bool is_ready_for(std::size_t rays) {
    const std::uint32_t left = few_left_.load(std::memory_order_relaxed);
    if (left < rays) return false;
    // Threads at once may count less than all: the plan is only an estimate.
    few_left_.store(left - static_cast<std::uint32_t>(rays), std::memory_order_relaxed);
    return true;
  }

  /// Passes on the hit of each ray with the least (t, triangle).
  void closest_hit(const Executor& executor, const RaySource& rays, const PlannedOptions& options,
                   const HitSink& sink, QueryReport* report);

  /// Sets occluded[i] to 1 if ray i hits anything.
  void any_hit(const Executor& executor, const RaySource& rays, const PlannedOptions& options,
               View<std::uint8_t> occluded, QueryReport* report);

  /// Every hit of every ray.
  [[nodiscard]] FoundRows all_hits(const Executor& executor, const RaySource& rays,
                                   const PlannedOptions& options, QueryReport* report);
  /// The number of hits, without storing them.
  void hit_counts(const Executor& executor, const RaySource& rays, const PlannedOptions& options,
                  View<std::uint32_t> hit_counts, QueryReport* report);

  /// The tree, and the memory that is kept for the next query.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  friend class TreeQueries;

  /// Counts the rays of `is_ready_for` as traced; nothing is ready until the tree is.
  void count_few();
  /// Updates the tree as planned, as far as that can be done.
  void prepare_tree(const Executor& executor, TreePlan* plan, QueryReport* report);
  /// Continues with the fine tree if the plan has one; the plan then uses it where it is complete.
  void build_fine_slice(const Executor& executor, TreePlan* plan);
  /// Builds, replaces or refits the tree; returns what was done, where the plan's work had to
  /// become a rebuild.
  [[nodiscard]] TreeWork update_tree(const Executor& executor, const TreePlan& plan);
  /// Plans the query, prepares the tree, and tells the report.
  [[nodiscard]] Plan prepare(const Executor& executor, const RaySource& rays, bool any,
                             const PlannedOptions& options, QueryReport* report);
  /// Takes the rays, kFewTogether at a time, and calls `trace(begin, rays, scene, counts)`, with
  /// the filter of these rays in the scene.
  template <class Trace>
  void trace_few(const Executor& executor, const RaySource& rays, const DualScene& scene,
                 QueryReport* report, const Trace& trace) const;
  /// Takes and orders all rays at once, and calls `trace(rays, counts)`.
  template <class Trace>
  void trace_whole(const Executor& executor, const RaySource& rays, const Plan& plan,
                   QueryReport* report, const Trace& trace);
  /// Sorts the rays by quarter, as many as are traced together, and calls `trace(quartered,
  /// counts)`.
  template <class Trace>
  void trace_quartered(const Executor& executor, const RaySource& rays, QueryReport* report,
                       const Trace& trace);
  [[nodiscard]] DualScene dual_scene(const Plan& plan, const PlannedOptions& options) const;

  TriangleSource source_;
  ObjectTree tree_;
  MovedTriangles moved_;                    ///< since the tree was built or refitted
  FineBuild fine_;                          ///< in addition to the tree
  double fine_ns_ = 0;                      ///< that it may take, saved up
  std::uint32_t few_granted_ = 0;           ///< rays that need no plan, since the last plan
  std::atomic<std::uint32_t> few_left_{0};  ///< of these
  SceneHistory history_;
  bool keep_flat_ = false;  ///< areas of triangles come and go: the tree holds those without one
  RayOrder order_;
  RowLists rows_;
  std::unique_ptr<RayStreamPool> streams_ = std::make_unique<RayStreamPool>();
  std::unique_ptr<Spares<RayTile>> tiles_ = std::make_unique<Spares<RayTile>>();
  std::unique_ptr<QuarteredRays> quartered_ = std::make_unique<QuarteredRays>();
};

}  // namespace raysheaf
