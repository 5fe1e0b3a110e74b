// The CPU's answers: rays by the method `dual`, points down the same tree.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "api/name_rows.h"
#include "api/query_call.h"
#include "api/scene_queries.h"
#include "exec/stopwatch.h"
#include "levels/trace_levels.h"
#include "nearest/closest_body.h"
#include "queries/level_way.h"

namespace raysheaf {
namespace {

PlannedOptions planned_options(QueryCall& call) {
  PlannedOptions options;
  options.count = call.report() != nullptr && call.options().count_tests;
  options.filter = call.filter();
  options.ready = call.is_ready();
  return options;
}

/// Fills `results` by the instances that the rays enter, after `trace_view(rays)` has done so by
/// the view of the others, if there are any; returns whether rays enter instances. `rows`: what
/// `trace_view` fills with all hits.
template <class TraceView>
bool trace(QueryCall& call, const QueryRays& rays, LevelResults results, const HitRows* rows,
           const TraceView& trace_view) {
  const std::span<const float> times = call.options().ray_times;
  const Entered& entered = call.enter({.rays = rays.size()}, !times.empty());
  if (entered.levels == nullptr) {
    trace_view(rays);
    return false;
  }
  Buffer<Ray> room;
  const View<const Ray> all = call.take_all(rays, &room);
  QueryReport* const report = call.report();
  if (!entered.part.empty()) {
    std::vector<std::string> plan;
    if (report != nullptr) plan = std::move(report->plan);
    trace_view(QueryRays(std::span(all.data, all.size), false));
    if (report != nullptr) report->plan.insert(report->plan.begin(), plan.begin(), plan.end());
    results.go_on = true;
    if (rows != nullptr) results.offsets = rows->offsets.data(), results.begun = rows->hits.data();
  }
  const Stopwatch watch;
  DualCounts counts;
  const bool counted = report != nullptr && call.options().count_tests;
  trace_levels(call.executor(), entered.levels->scene(times.data()), all,
               choice_of_hits(call.options()), results, counted ? &counts : nullptr,
               plan_level_way(rays));
  call.add_time(&QueryReport::trace_ms, watch.ms());
  if (counted) report->add(counts);
  return true;
}

/// Calls `find(scene, closed)`: the instances where they stand, or the trees brought to where the
/// triangles are. `rule`: the query asks what is inside.
template <class Find>
void with_scene(QueryCall& call, const QueryPoints& points, const InsideRule* rule,
                const Find& find) {
  NearestScene scene;
  LevelScene levels;
  bool closed = false;
  const Levels* const entered = call.enter({.points = points.size()}).levels;
  if (entered != nullptr) {
    levels = entered->scene();
    scene.levels = &levels;
    scene.worlds = worlds_of(call.options());
    scene.mask = call.options().mask;
    closed = rule != nullptr && call.is_closed(*rule, &scene);
  } else {
    SceneView& view = call.open();
    const ObjectTree& tree = view.engine.prepare_tree(call.executor(), call.report());
    view.engine.add_rays(points.size());
    const Stopwatch watch;
    scene = view.points.scene(call.executor(), view.source(), tree, view.version());
    scene.filter = call.filter();
    call.add_time(&QueryReport::hierarchy_ms, watch.ms());
    closed = rule != nullptr && call.is_closed(*rule);
  }
  const Stopwatch watch;
  find(scene, closed);
  call.add_time(&QueryReport::trace_ms, watch.ms());
}

ClosestPoint closest_point_of(const NearestScene& scene, Point p, const FoundTriangle& found) {
  if (found.triangle == kNoTriangle) return {};
  const auto [a, b, c] = scene.corners(found);
  ClosestPoint one = closest_point_on(p, static_cast<std::uint32_t>(found.triangle), a, b, c);
  if (scene.levels == nullptr) return one;
  one.geom_id = scene.levels->instances[found.tree].geom_id;
  one.inst_id = scene.levels->instances[found.tree].inst_id;
  return one;
}

class QueriesByPlan final : public SceneQueries {
 public:
  void closest_hit(QueryCall& call, const QueryRays& rays, std::span<Hit> hits) const override {
    trace(call, rays, {.hits = hits}, nullptr, [&](const QueryRays& all) {
      SceneView& view = call.open();
      view.engine.closest_hit(
          call.executor(), all, planned_options(call),
          [&](std::size_t begin, View<const IndexedHit> found) {
            view.name_hits(found, hits.data() + begin);
          },
          call.report());
    });
  }
  void any_hit(QueryCall& call, const QueryRays& rays,
               std::span<std::uint8_t> occluded) const override {
    trace(call, rays, {.occluded = occluded}, nullptr, [&](const QueryRays& all) {
      SceneView& view = call.open();
      view.engine.any_hit(call.executor(), all, planned_options(call), occluded, call.report());
    });
  }
  void hit_counts(QueryCall& call, const QueryRays& rays,
                  std::span<std::uint32_t> counts) const override {
    trace(call, rays, {.hit_counts = counts}, nullptr, [&](const QueryRays& all) {
      SceneView& view = call.open();
      view.engine.hit_counts(call.executor(), all, planned_options(call), counts, call.report());
    });
  }
  void all_hits(QueryCall& call, const QueryRays& rays, std::size_t most,
                HitRows* rows) const override {
    LevelRows met;
    const bool entered = trace(call, rays, {.rows = &met}, rows, [&](const QueryRays& all) {
      SceneView& view = call.open();
      const FoundRows found =
          view.engine.all_hits(call.executor(), all, planned_options(call), call.report());
      name_rows(
          call.executor(), found, most,
          [&](View<const IndexedHit> hits, Hit* out) { view.name_hits(hits, out); }, rows);
    });
    if (!entered) return;
    name_rows(
        call.executor(), met, most,
        [](View<const Hit> hits, Hit* out) { std::copy(hits.begin(), hits.end(), out); }, rows);
  }

  void nearest(QueryCall& call, const QueryPoints& points,
               std::span<ClosestPoint> found) const override {
    const std::size_t k = found.size() / points.size();
    with_scene(call, points, nullptr, [&](const NearestScene& scene, bool) {
      find_nearest(call.executor(), scene, points, static_cast<std::uint32_t>(k),
                   [&](const NearestTile& tile) {
                     ClosestPoint* const to = found.data() + tile.begin * k;
                     for (std::size_t i = 0; i < tile.found.size; ++i)
                       to[i] = closest_point_of(scene, tile.points[i / k].at, tile.found[i]);
                     if (scene.levels == nullptr) call.view().name_points({to, tile.found.size});
                   });
    });
  }
  void signed_distance(QueryCall& call, const QueryPoints& points, InsideRule rule,
                       std::span<double> distances) const override {
    with_scene(call, points, &rule, [&](const NearestScene& scene, bool closed) {
      find_signed_distances(call.executor(), scene, points, rule, closed, distances);
    });
  }
  void contains(QueryCall& call, const QueryPoints& points, InsideRule rule,
                std::span<std::uint8_t> inside) const override {
    with_scene(call, points, &rule, [&](const NearestScene& scene, bool closed) {
      find_inside(call.executor(), scene, points, rule, closed, inside);
    });
  }
};

}  // namespace

const SceneQueries& by_plan() {
  static const QueriesByPlan queries;
  return queries;
}

}  // namespace raysheaf
