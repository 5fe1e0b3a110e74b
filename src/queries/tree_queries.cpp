#include "queries/tree_queries.h"

#include <utility>

#include "exec/stopwatch.h"

namespace raysheaf {
DualScene TreeQueries::prepare(const PlannedQueries& engine, View<const Ray> rays,
                               const PlannedOptions& options, bool explain, QueryReport* report) {
  const Stopwatch watch;
  const RayPlan plan = plan_rays(RaysInPlace(rays), &engine.tree_.bounds);
  order_rays(executor_, rays, &order_, plan.row);
  if (explain)
    for (std::string& sentence : raysheaf::explain(plan))
      report->plan.push_back(std::move(sentence));
  report->lap(&QueryReport::order_ms, watch.ms());
  return {&engine.tree_, engine.source_.flags, options.facing, plan.bundle, &streams_};
}

void TreeQueries::closest_hit(const PlannedQueries& engine, View<const Ray> rays,
                              const PlannedOptions& options, bool explain, View<IndexedHit> hits,
                              View<float> ray_tests, QueryReport* report) {
  if (rays.empty()) return;
  const DualScene scene = prepare(engine, rays, options, explain, report);
  const Stopwatch watch;
  DualCounts counts;
  trace_rays(executor_, scene, rays, order_, {.hits = hits, .ray_tests = ray_tests}, &counts);
  report->add(counts);
  report->lap(&QueryReport::trace_ms, watch.ms());
}

void TreeQueries::any_hit(const PlannedQueries& engine, View<const Ray> rays,
                          const PlannedOptions& options, bool explain, View<std::uint8_t> occluded,
                          View<float> ray_tests, QueryReport* report) {
  if (rays.empty()) return;
  const DualScene scene = prepare(engine, rays, options, explain, report);
  const Stopwatch watch;
  DualCounts counts;
  trace_rays(executor_, scene, rays, order_, {.occluded = occluded, .ray_tests = ray_tests},
             &counts);
  report->add(counts);
  report->lap(&QueryReport::trace_ms, watch.ms());
}

}  // namespace raysheaf
