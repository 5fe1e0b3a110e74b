#include "engine/engine.h"

#include <algorithm>
#include <chrono>

#include "exec/scan.h"

namespace raysheaf {
namespace {

/// A tree whose expected cost has grown by this much is not worth refitting.
constexpr float kSpoilt = 1.5f;

bool precedes(const EngineHit& a, const EngineHit& b) {
  return a.t < b.t || (a.t == b.t && a.triangle < b.triangle);
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
    if (report_ == nullptr) return;
    report_->bound_tests += counts.beam_box_tests;
    report_->ray_bound_tests += counts.ray_box_tests;
    report_->triangle_tests += counts.triangle_tests;
  }

 private:
  EngineReport* report_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// `counts[hit.ray]` grows by the number of each ray's hits.
template <class Count>
void count_hits_of(const Executor& executor, const RowLists& found, Count* counts) {
  executor.for_each(found.size(), 1, [&](std::size_t list) {
    for (const RowHit& hit : found[list]) ++counts[hit.ray];  // nobody else has this ray
  });
}

EngineHitRows to_rows(const Executor& executor, const RowLists& found, std::size_t ray_count) {
  EngineHitRows rows;
  rows.offsets.assign(ray_count + 1, 0);
  count_hits_of(executor, found, rows.offsets.data() + 1);
  for (std::size_t i = 0; i < ray_count; ++i) rows.offsets[i + 1] += rows.offsets[i];
  rows.hits.resize(rows.offsets.back());
  std::vector<std::uint64_t> next(rows.offsets.begin(), rows.offsets.end() - 1);
  executor.for_each(found.size(), 1, [&](std::size_t list) {
    for (const RowHit& hit : found[list]) rows.hits[next[hit.ray]++] = hit.hit;
  });
  executor.for_each(ray_count, 1024, [&](std::size_t i) {
    std::sort(rows.hits.begin() + static_cast<std::ptrdiff_t>(rows.offsets[i]),
              rows.hits.begin() + static_cast<std::ptrdiff_t>(rows.offsets[i + 1]), precedes);
  });
  return rows;
}

}  // namespace

void Engine::set_triangles(const TriangleSource& source, bool same_triangles) {
  const bool keeps = same_triangles && source.count == source_.count;
  source_ = source;
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

void Engine::prepare(const Executor& executor, View<const Ray> rays, Plan* plan,
                     EngineReport* report) {
  Reporter reporter(report);
  const bool refitted =
      plan->tree == TreeWork::kRefit && refit_object_tree(executor, source_, &tree_);
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
  history_.degraded = tree_.surface_area_cost > kSpoilt * cost_when_built_;
  history_.rays_since_change += rays.size;
  reporter.lap(&EngineReport::hierarchy_ms);
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

RowLists Engine::find_all(const Executor& executor, View<const Ray> rays,
                          const EngineOptions& options, EngineReport* report) {
  Plan plan = make_plan(history_, rays, false, report != nullptr);
  ++history_.queries_since_change;
  prepare(executor, rays, &plan, report);
  Reporter reporter(report);
  DualCounts counts;
  RowLists found = trace_all(executor, dual_scene(plan, options), rays, order_, {}, &counts);
  reporter.lap(&EngineReport::trace_ms);
  reporter.add(counts);
  return found;
}

EngineHitRows Engine::all_hits(const Executor& executor, View<const Ray> rays,
                               const EngineOptions& options, EngineReport* report) {
  if (rays.empty()) return {{0}, {}};
  const RowLists found = find_all(executor, rays, options, report);
  Reporter reporter(report);
  EngineHitRows rows = to_rows(executor, found, rays.size);
  reporter.lap(&EngineReport::trace_ms);
  return rows;
}

void Engine::count_hits(const Executor& executor, View<const Ray> rays,
                        const EngineOptions& options, View<std::uint32_t> counts,
                        EngineReport* report) {
  std::fill(counts.begin(), counts.end(), 0u);
  if (rays.empty()) return;
  const RowLists found = find_all(executor, rays, options, report);
  Reporter reporter(report);
  count_hits_of(executor, found, counts.data);
  reporter.lap(&EngineReport::trace_ms);
}

std::size_t Engine::memory_bytes() const {
  return tree_.memory_bytes() + order_.rays.capacity_bytes() + order_.keys.capacity_bytes() +
         order_.spare.capacity_bytes() + streams_->bytes() + fan_memory_.bytes();
}

}  // namespace raysheaf
