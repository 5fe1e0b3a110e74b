#include "engine/engine.h"

#include <algorithm>
#include <chrono>

#include "exec/scan.h"

namespace raysheaf {
namespace {

/// A tree whose expected cost has grown by this much is not worth refitting.
constexpr float kSpoilt = 1.5f;

/// Found rows beyond are given back with the next query.
constexpr std::size_t kMostRowBytes = std::size_t{64} << 20;

std::size_t bytes_of(const RowLists& lists) {
  std::size_t bytes = 0;
  for (const RowList& list : lists)
    bytes += list.ends.capacity_bytes() + list.hits.capacity_bytes();
  return bytes;
}

/// Adds to the report where there is one; times what was done since the last lap.
class Reporter {
 public:
  explicit Reporter(EngineReport* report) : report_(report) {}

  void lap(double EngineReport::*field) {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    if (report_ == nullptr) return;
    report_->*field += ms;
    report_->total_ms += ms;
  }
  void add(const DualCounts& counts) {
    if (report_ != nullptr) report_->add(counts);
  }

 private:
  EngineReport* report_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

void Engine::set_triangles(const TriangleSource& source, bool same_triangles) {
  const bool keeps = same_triangles && source.count == source_.count;
  source_ = source;
  moved_.add_all();
  if (keeps) {
    history_.rays_since_change = 0;
    history_.queries_since_change = 0;
    history_.moved = true;
    ++history_.moves;
    return;
  }
  SceneHistory fresh;
  fresh.triangles = source.count;
  fresh.fan_pairs = history_.fan_pairs;
  history_ = fresh;
}

void Engine::move_triangles(const TriangleSource& source, View<const TriangleRange> moved) {
  MovedTriangles all_moved = std::exchange(moved_, {});
  set_triangles(source, true);
  for (const TriangleRange& range : moved) all_moved.add(range, source.count);
  moved_ = std::move(all_moved);
}

void Engine::prepare_tree(const Executor& executor, EngineReport* report) {
  Plan plan = plan_tree(history_, report != nullptr);
  prepare_tree(executor, &plan, report);
  if (report != nullptr) report->plan = std::move(plan.reasons);
}

void Engine::prepare_tree(const Executor& executor, Plan* plan, EngineReport* report) {
  Reporter reporter(report);
  // Until it is whole: memory may run out, and callers stop.
  if (plan->tree != TreeWork::kKeep) history_.built = false;
  const bool refitted =
      plan->tree == TreeWork::kRefit && refit_object_tree(executor, source_, moved_, &tree_);
  if (plan->tree == TreeWork::kRefit && !refitted && report != nullptr)
    plan->reasons.emplace_back(
        "object tree: built again after all, for triangles without area have gained an area");
  if (plan->tree == TreeWork::kRebuildFinely) {
    build_fine_object_tree(executor, source_, &tree_);
  } else if (plan->tree != TreeWork::kKeep && !refitted) {
    build_object_tree(executor, source_, &tree_);
  }
  if (report != nullptr) {
    report->used_tree = true;
    report->tree = plan->tree == TreeWork::kRefit && !refitted ? TreeWork::kRebuild : plan->tree;
  }
  if (plan->tree != TreeWork::kKeep && !refitted) {
    // A fine tree that was spoilt is tried again, but not so soon.
    if (history_.fine && plan->tree != TreeWork::kRebuildFinely)
      history_.patience = history_.moves + 2 * history_.patience;
    history_.fine = plan->tree == TreeWork::kRebuildFinely;
    cost_when_built_ = tree_.surface_area_cost;
  }
  history_.built = true;
  history_.moved = false;
  moved_.clear();
  history_.degraded = tree_.surface_area_cost > kSpoilt * cost_when_built_;
  reporter.lap(&EngineReport::hierarchy_ms);
}

void Engine::prepare(const Executor& executor, View<const Ray> rays, Plan* plan,
                     EngineReport* report) {
  prepare_tree(executor, plan, report);
  history_.rays_since_change += rays.size;
  Reporter reporter(report);
  choose_sorting(tree_.surface_area_cost, report != nullptr, plan);
  order_rays(executor, rays, plan->sort ? Sorting::kCurve : Sorting::kByQuarter, &order_);
  reporter.lap(&EngineReport::order_ms);
  if (report != nullptr) report->plan = std::move(plan->reasons);
}

DualScene Engine::dual_scene(const Plan& plan, const EngineOptions& options) const {
  return {&tree_, source_.flags, options.facing, plan.bundle, streams_.get()};
}

void Engine::closest_hit(const Executor& executor, View<const Ray> rays,
                         const EngineOptions& options, View<EngineHit> hits, View<float> ray_tests,
                         EngineReport* report) {
  if (rays.empty()) return;
  Plan plan = make_plan(history_, rays, false, report != nullptr);
  ++history_.queries_since_change;
  prepare(executor, rays, &plan, report);
  Reporter reporter(report);
  DualCounts counts;
  trace_closest(executor, dual_scene(plan, options), rays, order_, hits, ray_tests, &counts);
  reporter.lap(&EngineReport::trace_ms);
  reporter.add(counts);
}

bool Engine::any_hit_in_fan(const Executor& executor, View<const Ray> rays,
                            const EngineOptions& options, View<std::uint8_t> occluded,
                            View<float> ray_tests, EngineReport* report) {
  FanCounts counts;
  const FanOptions fan{options.facing, options.count, &fan_memory_};
  if (!occluded_in_fan(executor, source_, rays, fan, occluded, ray_tests, &counts)) return false;
  if (source_.count != 0)
    history_.fan_pairs = static_cast<double>(counts.pairs) / static_cast<double>(source_.count);
  if (report == nullptr) return true;
  report->bound_tests += counts.bound_tests;
  report->triangle_tests += counts.triangle_tests;
  report->order_ms += counts.order_ms;
  report->hierarchy_ms += counts.hierarchy_ms;
  report->trace_ms += counts.traverse_ms;
  report->total_ms += counts.order_ms + counts.hierarchy_ms + counts.traverse_ms;
  return true;
}

void Engine::any_hit(const Executor& executor, View<const Ray> rays, const EngineOptions& options,
                     View<std::uint8_t> occluded, View<float> ray_tests, EngineReport* report) {
  if (rays.empty()) return;
  Plan plan = make_plan(history_, rays, true, report != nullptr);
  if (plan.fan) {
    if (any_hit_in_fan(executor, rays, options, occluded, ray_tests, report)) {
      ++history_.queries_since_change;
      if (report != nullptr) report->plan = std::move(plan.reasons);
      return;
    }
    plan = plan_without_fan(history_, rays, report != nullptr);
  }
  ++history_.queries_since_change;
  prepare(executor, rays, &plan, report);
  Reporter reporter(report);
  DualCounts counts;
  trace_any(executor, dual_scene(plan, options), rays, order_, occluded, ray_tests, &counts);
  reporter.lap(&EngineReport::trace_ms);
  reporter.add(counts);
}

FoundRows Engine::all_hits(const Executor& executor, View<const Ray> rays,
                           const EngineOptions& options, EngineReport* report) {
  if (bytes_of(rows_) > kMostRowBytes) rows_.clear();
  if (!rays.empty()) {
    Plan plan = make_plan(history_, rays, false, report != nullptr);
    ++history_.queries_since_change;
    prepare(executor, rays, &plan, report);
    Reporter reporter(report);
    DualCounts counts;
    trace_all(executor, dual_scene(plan, options), rays, order_, &rows_, {}, &counts);
    reporter.lap(&EngineReport::trace_ms);
    reporter.add(counts);
  } else {
    rows_.clear();
  }
  return {rows_, {order_.rays.data(), order_.rays.size()}};
}

std::size_t Engine::memory_bytes() const {
  return tree_.memory_bytes() + order_.rays.capacity_bytes() + order_.keys.capacity_bytes() +
         order_.spare.capacity_bytes() + order_.quarters.capacity_bytes() + streams_->bytes() +
         fan_memory_.bytes() + bytes_of(rows_) + moved_.memory_bytes();
}

}  // namespace raysheaf
