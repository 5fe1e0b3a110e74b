// The CPU's answers: rays by the method `dual`, points down the same tree.
#include <algorithm>
#include <optional>
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

/// The rays of a query, which go through the view of what is placed, if there is any, and on to the
/// instances that they enter, if there are any.
class RayPasses {
 public:
  RayPasses(QueryCall& call, const QueryRays& rays)
      : call_(call),
        given_(rays),
        entered_(call.enter({.rays = rays.size()}, !call.options().ray_times.empty())) {
    if (entered_.levels == nullptr) return;
    all_ = call.take_all(rays, &room_);
    taken_.emplace(std::span(all_.data, all_.size), false);
    if (through_view() && call.report() != nullptr) plan_ = std::move(call.report()->plan);
  }

  [[nodiscard]] bool through_view() const {
    return entered_.levels == nullptr || !entered_.part.empty();
  }
  /// For the view.
  [[nodiscard]] const QueryRays& rays() const { return taken_ ? *taken_ : given_; }

  /// Goes on from the results of the view. `rows`: what has all hits there. Returns whether rays
  /// enter instances.
  bool go_on(LevelResults results, const HitRows* rows = nullptr) {
    if (entered_.levels == nullptr) return false;
    QueryReport* const report = call_.report();
    if (through_view()) {
      if (report != nullptr) report->plan.insert(report->plan.begin(), plan_.begin(), plan_.end());
      results.go_on = true;
      if (rows != nullptr)
        results.offsets = rows->offsets.data(), results.begun = rows->hits.data();
    }
    const Stopwatch watch;
    DualCounts counts;
    const bool counted = report != nullptr && call_.options().count_tests;
    trace_levels(call_.executor(), entered_.levels->scene(call_.options().ray_times.data()), all_,
                 choice_of_hits(call_.options()), results, counted ? &counts : nullptr,
                 plan_level_way(given_));
    call_.add_time(&QueryReport::trace_ms, watch.ms());
    if (counted) report->add(counts);
    return true;
  }

 private:
  QueryCall& call_;
  const QueryRays& given_;
  const Entered& entered_;
  Buffer<Ray> room_;
  View<const Ray> all_;             ///< if instances are entered
  std::optional<QueryRays> taken_;  ///< the same, valid
  std::vector<std::string> plan_;
};

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
    RayPasses passes(call, rays);
    if (passes.through_view()) {
      SceneView& view = call.open();
      view.engine.closest_hit(
          call.executor(), passes.rays(), planned_options(call),
          [&](std::size_t begin, View<const IndexedHit> found) {
            view.name_hits(found, hits.data() + begin);
          },
          call.report());
    }
    passes.go_on({.hits = hits});
  }
  void any_hit(QueryCall& call, const QueryRays& rays,
               std::span<std::uint8_t> occluded) const override {
    RayPasses passes(call, rays);
    if (passes.through_view()) {
      SceneView& view = call.open();
      view.engine.any_hit(call.executor(), passes.rays(), planned_options(call), occluded,
                          call.report());
    }
    passes.go_on({.occluded = occluded});
  }
  void hit_counts(QueryCall& call, const QueryRays& rays,
                  std::span<std::uint32_t> counts) const override {
    RayPasses passes(call, rays);
    if (passes.through_view()) {
      SceneView& view = call.open();
      view.engine.hit_counts(call.executor(), passes.rays(), planned_options(call), counts,
                             call.report());
    }
    passes.go_on({.hit_counts = counts});
  }
  void all_hits(QueryCall& call, const QueryRays& rays, std::size_t most,
                HitRows* rows) const override {
    RayPasses passes(call, rays);
    if (passes.through_view()) {
      SceneView& view = call.open();
      const FoundRows found = view.engine.all_hits(call.executor(), passes.rays(),
                                                   planned_options(call), call.report());
      name_rows(
          call.executor(), found, most,
          [&](View<const IndexedHit> hits, Hit* out) { view.name_hits(hits, out); }, rows);
    }
    LevelRows met;
    if (!passes.go_on({.rows = &met}, rows)) return;
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
