#include "queries/tree_queries.h"

#include <utility>

#include "exec/stopwatch.h"

namespace raysheaf {
namespace {

void add(const DualCounts& counts, double ms, QueryReport* report) {
  report->add(counts);
  report->trace_ms += ms;
  report->total_ms += ms;
}

}  // namespace

DualScene TreeQueries::prepare(const PlannedQueries& engine, View<const Ray> rays,
                               const PlannedOptions& options, bool explain, QueryReport* report) {
  const Stopwatch watch;
  Plan plan = plan_rays(RaysInPlace(rays), engine.tree_.bounds, explain);
  order_rays(executor_, rays, Sorting::kByQuarter, &order_, plan.row);
  for (std::string& sentence : plan.reasons) report->plan.push_back(std::move(sentence));
  const double ms = watch.ms();
  report->order_ms += ms;
  report->total_ms += ms;
  return {&engine.tree_, engine.source_.flags, options.facing, plan.bundle, &streams_};
}

void TreeQueries::closest_hit(const PlannedQueries& engine, View<const Ray> rays,
                              const PlannedOptions& options, bool explain, View<IndexedHit> hits,
                              View<float> ray_tests, QueryReport* report) {
  if (rays.empty()) return;
  const DualScene scene = prepare(engine, rays, options, explain, report);
  const Stopwatch watch;
  DualCounts counts;
  trace_closest(executor_, scene, rays, order_, hits, ray_tests, &counts);
  add(counts, watch.ms(), report);
}

void TreeQueries::any_hit(const PlannedQueries& engine, View<const Ray> rays,
                          const PlannedOptions& options, bool explain, View<std::uint8_t> occluded,
                          View<float> ray_tests, QueryReport* report) {
  if (rays.empty()) return;
  const DualScene scene = prepare(engine, rays, options, explain, report);
  const Stopwatch watch;
  DualCounts counts;
  trace_any(executor_, scene, rays, order_, occluded, ray_tests, &counts);
  add(counts, watch.ms(), report);
}

}  // namespace raysheaf
