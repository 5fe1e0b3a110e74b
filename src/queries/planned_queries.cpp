#include "queries/planned_queries.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "base/bits.h"
#include "exec/scan.h"
#include "exec/stopwatch.h"

namespace raysheaf {
namespace {

/// Larger memory of found rows is freed at the next query.
constexpr std::size_t kMostKeptBytes = std::size_t{64} << 20;

std::size_t bytes_of(const RowLists& lists) {
  std::size_t bytes = 0;
  for (const RowList& list : lists)
    bytes += list.ends.capacity_bytes() + list.hits.capacity_bytes();
  return bytes;
}

/// After so many rays of small batches the tree is planned again.
constexpr std::uint32_t kFewBetweenPlans = 1024;

/// Adds to the report, if there is one; measures the time since the last lap.
class Reporter {
 public:
  explicit Reporter(QueryReport* report) : report_(report), watch_(report != nullptr) {}

  void lap(double QueryReport::*stage) {
    if (report_ != nullptr) report_->lap(stage, watch_.lap_ms());
  }
  void add(const DualCounts& counts) {
    if (report_ != nullptr) report_->add(counts);
  }

 private:
  QueryReport* report_;
  Stopwatch watch_;
};

/// For rays of `is_ready_for`.
Plan few_as_they_are() {
  Plan plan;
  plan.stages = Stages::kFew;
  return plan;
}

/// Options of a query that one stage after the other answers for the whole batch.
PlannedOptions as_whole(PlannedOptions options) {
  options.whole = true;
  return options;
}

}  // namespace

void PlannedQueries::set_triangles(const TriangleSource& source, bool same_triangles) {
  const bool keeps = same_triangles && source.count == source_.count;
  count_few();
  source_ = source;
  moved_.add_all();
  if (keeps) return history_.moved();
  fine_.abandon();
  keep_flat_ = false;
  history_.replaced(source.count, joining_of(source));
}

void PlannedQueries::move_triangles(const TriangleSource& source, View<const TriangleRange> moved) {
  MovedTriangles all_moved = std::exchange(moved_, {});
  set_triangles(source, true);
  for (const TriangleRange& range : moved) all_moved.add(range, source.count);
  moved_ = std::move(all_moved);
}

void PlannedQueries::count_few() {
  const std::uint32_t traced = std::exchange(few_granted_, 0) - few_left_.exchange(0);
  if (traced != 0) add_rays(traced);
}

const ObjectTree& PlannedQueries::prepare_tree(const Executor& executor, QueryReport* report) {
  count_few();
  TreePlan plan = history_.plan({});
  prepare_tree(executor, &plan, report);
  if (report != nullptr) report->plan = explain(plan);
  return tree_;
}

void PlannedQueries::add_rays(std::uint64_t count) {
  history_.traced({count, false});
  fine_ns_ += history_.slice({count, false});
}

void PlannedQueries::build_fine_slice(const Executor& executor, TreePlan* plan) {
  if (!plan->finely || tree_.empty()) {
    if (fine_.has_begun()) {
      history_.fine_tree_was_given_up();
      fine_.abandon();
    }
    fine_ns_ = 0;
    return;
  }
  FineBuild fine = std::exchange(fine_, {});  // is lost if memory runs out, or the caller cancels
  if (!fine.has_begun()) fine.begin(tree_);
  if (plan->reason == TreeReason::kMoved) fine.triangles_moved();
  fine_ns_ += history_.slice(plan->rays);
  fine_ns_ -= fine.advance(executor, source_, tree_, fine_ns_);
  fine_ = std::move(fine);
  if (fine_.is_complete()) plan->work = TreeWork::kRebuildFinely;
}

TreeWork PlannedQueries::update_tree(const Executor& executor, const TreePlan& plan) {
  const TreeWork work = plan.work;
  if (work == TreeWork::kKeep) return work;
  if (work == TreeWork::kRefit && refit_object_tree(executor, source_, moved_, &tree_)) return work;
  if (work == TreeWork::kRebuildFinely && !fine_.has_begun()) {
    build_fine_object_tree(executor, source_, &tree_);
    return work;
  }
  if (work == TreeWork::kRebuildFinely && fine_.finish(executor, source_, &tree_)) {
    if (plan.reason == TreeReason::kUnmoved) tree_.scratch = {};  // the next rebuild is far away
    return work;
  }
  fine_.abandon();
  // Where a refit failed, every further one will succeed.
  keep_flat_ |= work == TreeWork::kRefit || work == TreeWork::kRebuildFinely;
  if (history_.has_moved()) history_.joined(joining_of(source_));
  const bool coarse = work == TreeWork::kRebuildCoarsely;
  build_object_tree(executor, source_, &tree_,
                    {coarse ? kCoarseTriangles : kQuadTriangles, history_.joining(), keep_flat_});
  return coarse ? work : TreeWork::kRebuild;
}

void PlannedQueries::prepare_tree(const Executor& executor, TreePlan* plan, QueryReport* report) {
  Reporter reporter(report);
  build_fine_slice(executor, plan);
  if (plan->work != TreeWork::kKeep) history_.tree_changes();
  const TreeWork work = update_tree(executor, *plan);
  history_.tree_was(work, tree_.surface_area_cost);
  moved_.clear();
  few_left_ = few_granted_ = kFewBetweenPlans;
  plan->gained_area = work != plan->work;
  if (report != nullptr) {
    report->used_tree = true;
    report->tree = work;
  }
  reporter.lap(&QueryReport::hierarchy_ms);
}

Plan PlannedQueries::prepare(const Executor& executor, const RaySource& rays, bool any,
                             const PlannedOptions& options, QueryReport* report) {
  if (options.ready) return few_as_they_are();
  count_few();
  GivenChoices given = options.given;
  const bool together = options.whole || !options.ray_tests.empty();
  if (together) given.few = false;
  Plan plan = make_plan(history_, rays, any, given);
  if (together || (options.filter != nullptr && plan.stages != Stages::kFew))
    plan.stages = Stages::kWhole;
  prepare_tree(executor, &plan.tree, report);
  history_.traced(plan.tree.rays);
  if (report != nullptr) report->plan = explain(plan);
  return plan;
}

DualScene PlannedQueries::dual_scene(const Plan& plan, const PlannedOptions& options) const {
  return {&tree_, source_.flags, options.facing, plan.rays.bundle, streams_.get(), options.filter};
}

template <class Trace>
void PlannedQueries::trace_few(const Executor& executor, const RaySource& rays,
                               const DualScene& scene, QueryReport* report,
                               const Trace& trace) const {
  Reporter reporter(report);
  std::mutex mutex;
  executor.for_each(div_ceil(rays.size(), kFewTogether), 1, [&](std::size_t number) {
    const std::size_t begin = number * kFewTogether;
    StackRoom<Ray, kFewTogether> room;
    const View<const Ray> some =
        rays.take(begin, std::min(rays.size(), begin + kFewTogether), room.data());
    DualScene from_there = scene;
    HitFilter filter;
    if (scene.filter != nullptr) {
      filter = scene.filter->from(begin);
      from_there.filter = &filter;
    }
    DualCounts counts;
    trace(begin, some, from_there, &counts);
    if (report == nullptr) return;
    const std::lock_guard<std::mutex> lock(mutex);
    report->add(counts);
  });
  reporter.lap(&QueryReport::trace_ms);
}

template <class Trace>
void PlannedQueries::trace_whole(const Executor& executor, const RaySource& rays, const Plan& plan,
                                 QueryReport* report, const Trace& trace) {
  Reporter reporter(report);
  Buffer<Ray> room;
  const View<const Ray> all = take_all(executor, rays, &room);
  reporter.lap(&QueryReport::take_ms);
  order_rays(executor, all, &order_, plan.rays.row);
  reporter.lap(&QueryReport::order_ms);
  DualCounts counts;
  trace(all, &counts);
  reporter.lap(&QueryReport::trace_ms);
  reporter.add(counts);
}

template <class Trace>
void PlannedQueries::trace_quartered(const Executor& executor, const RaySource& rays,
                                     QueryReport* report, const Trace& trace) {
  Reporter reporter(report);
  for (std::size_t begin = 0; begin < rays.size(); begin += QuarteredRays::kMostRays) {
    DualCounts counts;
    const std::size_t end = std::min(rays.size(), begin + QuarteredRays::kMostRays);
    quartered_->take(executor, rays, begin, end);
    reporter.lap(&QueryReport::take_ms);
    trace(*quartered_, &counts);
    reporter.lap(&QueryReport::trace_ms);
    reporter.add(counts);
  }
}

void PlannedQueries::closest_hit(const Executor& executor, const RaySource& rays,
                                 const PlannedOptions& options, const HitSink& sink,
                                 QueryReport* report) {
  if (rays.size() == 0) return;
  const Plan plan = prepare(executor, rays, false, options, report);
  const DualScene scene = dual_scene(plan, options);
  if (plan.stages == Stages::kFew)
    return trace_few(executor, rays, scene, report,
                     [&](std::size_t begin, View<const Ray> some, const DualScene& from_there,
                         DualCounts* counts) {
                       StackRoom<IndexedHit, kFewTogether> room;
                       const View<IndexedHit> hits(room.data(), some.size);
                       trace_few_rays(executor, from_there, some, {.hits = hits}, counts);
                       sink(begin, View<const IndexedHit>(hits.data, hits.size));
                     });
  if (plan.stages == Stages::kTiles)
    return for_each_ray_tile(executor, rays, plan.rays.row, tiles_.get(), report,
                             [&](RayTile& tile, DualCounts* counts) {
                               tile.hits.resize_uninitialized(tile.rays.size);
                               trace_rays(Executor::serial(), scene, tile.rays, tile.order,
                                          {.hits = tile.hits}, counts);
                               sink(tile.begin, tile.hits);
                             });
  if (plan.stages == Stages::kCopies) {
    return trace_quartered(executor, rays, report, [&](QuarteredRays& all, DualCounts* counts) {
      trace_rays(executor, scene, all.rays(), all.order(), {.hits = all.hits()}, counts);
      all.hand_over_hits(executor, sink);
    });
  }
  Buffer<IndexedHit> hits;
  hits.resize_uninitialized(rays.size());
  trace_whole(executor, rays, plan, report, [&](View<const Ray> all, DualCounts* counts) {
    trace_rays(executor, scene, all, order_, {.hits = hits, .ray_tests = options.ray_tests},
               counts);
  });
  executor.for_each_block(rays.size(), kCopyGrain, [&](std::size_t begin, std::size_t end) {
    sink(begin, View<const IndexedHit>(hits).slice(begin, end - begin));
  });
}

void PlannedQueries::any_hit(const Executor& executor, const RaySource& rays,
                             const PlannedOptions& options, View<std::uint8_t> occluded,
                             QueryReport* report) {
  if (rays.size() == 0) return;
  const Plan plan = prepare(executor, rays, true, options, report);
  const DualScene scene = dual_scene(plan, options);
  if (plan.stages == Stages::kFew)
    return trace_few(executor, rays, scene, report,
                     [&](std::size_t begin, View<const Ray> some, const DualScene& from_there,
                         DualCounts* counts) {
                       trace_few_rays(executor, from_there, some,
                                      {.occluded = occluded.slice(begin, some.size)}, counts);
                     });
  if (plan.stages == Stages::kTiles)
    return for_each_ray_tile(executor, rays, plan.rays.row, tiles_.get(), report,
                             [&](RayTile& tile, DualCounts* counts) {
                               trace_rays(Executor::serial(), scene, tile.rays, tile.order,
                                          {.occluded = occluded.slice(tile.begin, tile.rays.size)},
                                          counts);
                             });
  if (plan.stages == Stages::kCopies) {
    return trace_quartered(executor, rays, report, [&](QuarteredRays& all, DualCounts* counts) {
      trace_rays(executor, scene, all.rays(), all.order(), {.occluded = all.occluded()}, counts);
      all.hand_over_occluded(executor, occluded);
    });
  }
  trace_whole(executor, rays, plan, report, [&](View<const Ray> all, DualCounts* counts) {
    trace_rays(executor, scene, all, order_, {.occluded = occluded, .ray_tests = options.ray_tests},
               counts);
  });
}

FoundRows PlannedQueries::all_hits(const Executor& executor, const RaySource& rays,
                                   const PlannedOptions& options, QueryReport* report) {
  if (rays.size() == 0 || bytes_of(rows_) > kMostKeptBytes) rows_.clear();
  if (rays.size() != 0) {
    const Plan plan = prepare(executor, rays, false, as_whole(options), report);
    const DualScene scene = dual_scene(plan, options);
    trace_whole(executor, rays, plan, report, [&](View<const Ray> all, DualCounts* counts) {
      trace_rays(executor, scene, all, order_, {.rows = &rows_}, counts);
    });
  }
  return {rows_, {order_.rays.data(), order_.rays.size()}};
}

void PlannedQueries::hit_counts(const Executor& executor, const RaySource& rays,
                                const PlannedOptions& options, View<std::uint32_t> hit_counts,
                                QueryReport* report) {
  if (rays.size() == 0) return;
  const Plan plan = prepare(executor, rays, false, as_whole(options), report);
  const DualScene scene = dual_scene(plan, options);
  trace_whole(executor, rays, plan, report, [&](View<const Ray> all, DualCounts* counts) {
    trace_rays(executor, scene, all, order_, {.hit_counts = hit_counts}, counts);
  });
}

std::size_t PlannedQueries::memory_bytes() const {
  return tree_.memory_bytes() + order_.bytes() + streams_->bytes() + tiles_->bytes() +
         quartered_->bytes() + bytes_of(rows_) + moved_.memory_bytes() + fine_.memory_bytes();
}

}  // namespace raysheaf
