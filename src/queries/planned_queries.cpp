#include "queries/planned_queries.h"

#include <algorithm>
#include <utility>

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

/// Occlusion is a byte per ray: copies of up to this many rays in the order of their quarters cost
/// more than reading the rays where they are.
constexpr std::size_t kMostReadInPlace = std::size_t{1} << 18;

/// Adds to the report, if there is one; measures the time since the last lap.
class Reporter {
 public:
  explicit Reporter(QueryReport* report) : report_(report) {}

  void lap(double QueryReport::*field) {
    const double ms = watch_.lap_ms();
    if (report_ == nullptr) return;
    report_->*field += ms;
    report_->total_ms += ms;
  }
  void add(const DualCounts& counts) {
    if (report_ != nullptr) report_->add(counts);
  }
  void add(const TileTimes& times) {
    if (report_ == nullptr) return;
    report_->take_ms += times.take_ms;
    report_->order_ms += times.order_ms;
    report_->trace_ms += times.trace_ms;
    report_->total_ms += times.take_ms + times.order_ms + times.trace_ms;
  }

 private:
  QueryReport* report_;
  Stopwatch watch_;
};

bool is_whole(const PlannedOptions& options) {
  return options.whole || options.filter != nullptr || !options.ray_tests.empty();
}

void tell_of_tiles(std::size_t rays, const Plan& plan, QueryReport* report) {
  if (report == nullptr) return;
  const std::size_t size = RayTiles::tile_size(rays, plan.row);
  report->plan.push_back("stages: one after the other for tiles of " +
                         std::to_string(std::min(rays, size)) +
                         " rays, because neighbours are coherent");
}

}  // namespace

void PlannedQueries::set_triangles(const TriangleSource& source, bool same_triangles) {
  const bool keeps = same_triangles && source.count == source_.count;
  source_ = source;
  moved_.add_all();
  if (keeps) {
    history_.move();
  } else {
    fine_.abandon();
    history_ = history_.replaced(source.count);
    history_.joining = joining_of(source);
  }
}

void PlannedQueries::move_triangles(const TriangleSource& source, View<const TriangleRange> moved) {
  MovedTriangles all_moved = std::exchange(moved_, {});
  set_triangles(source, true);
  for (const TriangleRange& range : moved) all_moved.add(range, source.count);
  moved_ = std::move(all_moved);
}

void PlannedQueries::prepare_tree(const Executor& executor, QueryReport* report) {
  Plan plan = plan_tree(history_, {}, report != nullptr);
  prepare_tree(executor, &plan, report);
  if (report != nullptr) report->plan = std::move(plan.reasons);
}

void PlannedQueries::add_rays(std::uint64_t count) {
  history_.trace({count, false});
  fine_ns_ += slice_of(history_, {count, false});
}

void PlannedQueries::build_fine_slice(const Executor& executor, Plan* plan) {
  FineBuild fine = std::exchange(fine_, {});  // is lost if memory runs out, or the caller cancels
  if (!plan->finely || tree_.empty()) {
    if (fine.has_begun()) history_.wait_longer();
    fine_ns_ = 0;
    return;
  }
  if (!fine.has_begun()) fine.begin(tree_);
  fine_ns_ += plan->slice_ns;
  fine_ns_ -= fine.advance(executor, tree_, fine_ns_);
  fine_ = std::move(fine);
  if (!fine_.is_complete()) return;
  plan->tree = TreeWork::kRebuildFinely;
  if (plan->reasons.empty()) return;
  // In place of why it was begun, and what would have been done to the former tree.
  plan->reasons.erase(plan->reasons.begin());
  plan->reasons.front() = "object tree: built finely, in slices";
}

TreeWork PlannedQueries::update_tree(const Executor& executor, TreeWork work) {
  if (work == TreeWork::kKeep) return work;
  if (work == TreeWork::kRefit && refit_object_tree(executor, source_, moved_, &tree_)) return work;
  if (work == TreeWork::kRebuildFinely && !fine_.has_begun()) {
    build_fine_object_tree(executor, source_, &tree_);
    return work;
  }
  if (work == TreeWork::kRebuildFinely && fine_.finish(executor, source_, &tree_)) {
    if (!history_.moved) tree_.scratch = {};  // the next rebuild is far away
    return work;
  }
  // Where a refit failed, every further one will succeed.
  fine_.abandon();
  history_.keep_flat |= work == TreeWork::kRefit || work == TreeWork::kRebuildFinely;
  if (history_.moves != 0) history_.joining = joining_of(source_);
  const bool coarse = work == TreeWork::kRebuildCoarsely;
  build_object_tree(
      executor, source_, &tree_,
      {coarse ? kCoarseTriangles : kQuadTriangles, history_.joining, history_.keep_flat});
  return coarse ? work : TreeWork::kRebuild;
}

void PlannedQueries::prepare_tree(const Executor& executor, Plan* plan, QueryReport* report) {
  Reporter reporter(report);
  build_fine_slice(executor, plan);
  // Marked as built only after it is complete: memory may run out, or the caller may cancel.
  if (plan->tree != TreeWork::kKeep) history_.built = false;
  const TreeWork work = update_tree(executor, plan->tree);
  if (report != nullptr) {
    if (work != plan->tree)
      plan->reasons.emplace_back(
          "object tree: built again after all, because triangles without area have gained an area");
    report->used_tree = true;
    report->tree = work;
  }
  if (work == TreeWork::kRefit) {
    history_.refit();
  } else if (work != TreeWork::kKeep) {
    if (history_.fine && work != TreeWork::kRebuildFinely) history_.wait_longer();
    history_.fine = work == TreeWork::kRebuildFinely;
    history_.coarse = work == TreeWork::kRebuildCoarsely;
    history_.coarse_loss = 0;
    cost_when_built_ = tree_.surface_area_cost;
  }
  history_.built = true;
  history_.moved = false;
  moved_.clear();
  history_.degraded = tree_.surface_area_cost > kSpoilt * cost_when_built_;
  reporter.lap(&QueryReport::hierarchy_ms);
}

void PlannedQueries::prepare(const Executor& executor, Plan* plan, QueryReport* report) {
  prepare_tree(executor, plan, report);
  history_.trace(plan->rays);
  if (report != nullptr) report->plan = std::move(plan->reasons);
}

void PlannedQueries::order(const Executor& executor, View<const Ray> rays, const Plan& plan,
                           QueryReport* report) {
  Reporter reporter(report);
  order_rays(executor, rays, Sorting::kByQuarter, &order_, plan.row);
  reporter.lap(&QueryReport::order_ms);
}

View<const Ray> PlannedQueries::take_all_rays(const Executor& executor, const RaySource& rays,
                                              Buffer<Ray>* room, QueryReport* report) {
  Reporter reporter(report);
  const View<const Ray> all = take_all(executor, rays, room);
  reporter.lap(&QueryReport::take_ms);
  return all;
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

DualScene PlannedQueries::dual_scene(const Plan& plan, const PlannedOptions& options) const {
  return {&tree_, source_.flags, options.facing, plan.bundle, streams_.get(), options.filter};
}

template <class Trace>
void PlannedQueries::trace_whole(const Executor& executor, View<const Ray> rays, const Plan& plan,
                                 QueryReport* report, const Trace& trace) {
  order(executor, rays, plan, report);
  Reporter reporter(report);
  DualCounts counts;
  trace(&counts);
  reporter.lap(&QueryReport::trace_ms);
  reporter.add(counts);
}

void PlannedQueries::closest_hit(const Executor& executor, const RaySource& rays,
                                 const PlannedOptions& options, const HitSink& sink,
                                 QueryReport* report) {
  if (rays.size() == 0) return;
  Plan plan = make_plan(history_, rays, false, report != nullptr, options.given);
  prepare(executor, &plan, report);
  const DualScene scene = dual_scene(plan, options);
  // With long streams, a tile has too few rays that traverse the tree together.
  if (plan.alike && !is_whole(options)) {
    tell_of_tiles(rays.size(), plan, report);
    Reporter reporter(report);
    DualCounts counts;
    reporter.add(tiles_->closest_hit(executor, rays, plan.row, scene, sink, &counts));
    reporter.add(counts);
    return;
  }
  if (plan.bundle == Bundle::kLongStream && !is_whole(options)) {
    trace_quartered(executor, rays, report, [&](QuarteredRays& all, DualCounts* counts) {
      trace_closest(executor, scene, all.rays(), all.order(), all.hits(), {}, counts);
      all.hand_over_hits(executor, sink);
    });
    return;
  }
  Buffer<Ray> room;
  const View<const Ray> all = take_all_rays(executor, rays, &room, report);
  Buffer<IndexedHit> hits;
  hits.resize_uninitialized(all.size);
  trace_whole(executor, all, plan, report, [&](DualCounts* counts) {
    trace_closest(executor, scene, all, order_, hits, options.ray_tests, counts);
  });
  executor.for_each_block(all.size, kCopyGrain, [&](std::size_t begin, std::size_t end) {
    sink(begin, View<const IndexedHit>(hits).slice(begin, end - begin));
  });
}

void PlannedQueries::any_hit(const Executor& executor, const RaySource& rays,
                             const PlannedOptions& options, View<std::uint8_t> occluded,
                             QueryReport* report) {
  if (rays.size() == 0) return;
  Plan plan = make_plan(history_, rays, true, report != nullptr, options.given);
  prepare(executor, &plan, report);
  const DualScene scene = dual_scene(plan, options);
  if (plan.alike && !is_whole(options)) {
    tell_of_tiles(rays.size(), plan, report);
    Reporter reporter(report);
    DualCounts counts;
    reporter.add(tiles_->any_hit(executor, rays, plan.row, scene, occluded, &counts));
    reporter.add(counts);
    return;
  }
  if (plan.bundle == Bundle::kLongStream && !is_whole(options) && rays.size() > kMostReadInPlace) {
    trace_quartered(executor, rays, report, [&](QuarteredRays& quartered, DualCounts* counts) {
      trace_any(executor, scene, quartered.rays(), quartered.order(), quartered.occluded(), {},
                counts);
      quartered.hand_over_occluded(executor, occluded);
    });
    return;
  }
  Buffer<Ray> room;
  const View<const Ray> all = take_all_rays(executor, rays, &room, report);
  trace_whole(executor, all, plan, report, [&](DualCounts* counts) {
    trace_any(executor, scene, all, order_, occluded, options.ray_tests, counts);
  });
}

template <class Trace>
void PlannedQueries::trace_every_hit(const Executor& executor, const RaySource& rays,
                                     QueryReport* report, const Trace& trace) {
  Plan plan = make_plan(history_, rays, false, report != nullptr);
  prepare(executor, &plan, report);
  Buffer<Ray> room;
  const View<const Ray> all = take_all_rays(executor, rays, &room, report);
  trace_whole(executor, all, plan, report, [&](DualCounts* counts) { trace(all, plan, counts); });
}

FoundRows PlannedQueries::all_hits(const Executor& executor, const RaySource& rays,
                                   const PlannedOptions& options, QueryReport* report) {
  if (rays.size() == 0 || bytes_of(rows_) > kMostKeptBytes) rows_.clear();
  if (rays.size() != 0)
    trace_every_hit(
        executor, rays, report, [&](View<const Ray> all, const Plan& plan, DualCounts* counts) {
          trace_all(executor, dual_scene(plan, options), all, order_, &rows_, {}, counts);
        });
  return {rows_, {order_.rays.data(), order_.rays.size()}};
}

void PlannedQueries::hit_counts(const Executor& executor, const RaySource& rays,
                                const PlannedOptions& options, View<std::uint32_t> hit_counts,
                                QueryReport* report) {
  if (rays.size() == 0) return;
  trace_every_hit(
      executor, rays, report, [&](View<const Ray> all, const Plan& plan, DualCounts* counts) {
        trace_hit_counts(executor, dual_scene(plan, options), all, order_, hit_counts, counts);
      });
}

std::size_t PlannedQueries::memory_bytes() const {
  return tree_.memory_bytes() + order_.bytes() + streams_->bytes() + tiles_->bytes() +
         quartered_->bytes() + bytes_of(rows_) + moved_.memory_bytes() + fine_.memory_bytes();
}

}  // namespace raysheaf
