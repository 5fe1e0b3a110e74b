// Every ray and every point with every triangle of the view: the reference for all other ways.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "api/query_call.h"
#include "api/scene_queries.h"
#include "exec/stopwatch.h"
#include "intersect/triangle_body.h"
#include "nearest/closest_body.h"
#include "nearest/crossing_body.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

/// Rays or points per task.
constexpr std::size_t kBruteGrain = 16;

/// Calls `take(number, corners)`, which says whether to go on, for the triangles in order.
template <class Take>
void for_each_triangle(const TriangleSource& source, const Take& take) {
  for (const TriangleRun& run : source.runs)
    for (std::uint32_t i = 0; i < run.count; ++i)
      if (!take(run.first + i, run.corners(i))) return;
}

/// Calls `answer(i, item, view)` for all items.
template <class Item, class Answer>
void for_each_item(QueryCall& call, const Source<Item>& items, const Answer& answer) {
  Buffer<Item> room;
  const View<const Item> all = call.take_all(items, &room);
  const SceneView& view = call.read();
  const Stopwatch watch;
  call.executor().for_each(all.size, kBruteGrain, [&](std::size_t i) {
    call.executor().check();
    answer(i, all[i], view);
  });
  call.add_time(&QueryReport::trace_ms, watch.ms());
  QueryReport* const report = call.report();
  if (report == nullptr) return;
  if (call.options().count_tests)
    report->triangle_tests = std::uint64_t{all.size} * view.source().count;
  report->plan = {kByBruteForce};
}

/// Calls `take(hit)`, which says whether to go on, for the hits of ray `number` by ascending
/// triangle.
template <class Take>
void for_each_hit(const TriangleSource& source, const Ray& ray, std::size_t number,
                  const HitFilter* filter, const Take& take) {
  const RaySetup setup = make_ray_setup(ray);
  for_each_triangle(source, [&](std::uint32_t triangle, const std::array<Vec3, 3>& corners) {
    TriangleHit hit;
    if (!intersect_triangle(setup, corners[0], corners[1], corners[2], &hit)) return true;
    if (filter != nullptr &&
        !filter->takes(static_cast<std::uint32_t>(number), triangle, hit.front))
      return true;
    return take(IndexedHit{hit.t, hit.u, hit.v, triangle});
  });
}

/// Writes the nearest triangles of a point, sorted, as many as `best` has room for.
void find_nearest(const TriangleSource& source, const QueryPoint& point, View<FoundTriangle> best) {
  std::fill(best.begin(), best.end(), FoundTriangle{});
  for_each_triangle(source, [&](std::uint32_t triangle, const std::array<Vec3, 3>& corners) {
    const TriangleDistance found = distance_to_triangle(point.at, to_point(corners[0]),
                                                        to_point(corners[1]), to_point(corners[2]));
    const FoundTriangle one{std::sqrt(found.squared), triangle};
    if (!(one.distance <= point.radius) || !is_nearer(one, *(best.end() - 1))) return true;
    FoundTriangle* const place = std::upper_bound(best.begin(), best.end(), one, is_nearer);
    std::move_backward(place, best.end() - 1, best.end());
    *place = one;
    return true;
  });
}

/// By all six rays.
bool winds_around(const TriangleSource& source, Point p, InsideRule rule) {
  std::int64_t winding = 0, odd = 0;
  for (int ray = 0; ray < kAxisRays; ++ray) {
    std::int64_t number = 0;
    for_each_triangle(source, [&](std::uint32_t /*triangle*/, const std::array<Vec3, 3>& corners) {
      const int crossed =
          crossing(p, to_point(corners[0]), to_point(corners[1]), to_point(corners[2]), ray);
      winding += crossed;
      number += std::abs(crossed);
      return true;
    });
    odd += number % 2;
  }
  return 2 * (rule == InsideRule::kNonZero ? std::abs(winding) : odd) > kAxisRays;
}

class QueriesByBruteForce final : public SceneQueries {
 public:
  void closest_hit(QueryCall& call, const QueryRays& rays, std::span<Hit> hits) const override {
    for_each_item(call, rays, [&](std::size_t i, const Ray& ray, const SceneView& view) {
      IndexedHit best;
      for_each_hit(view.source(), ray, i, call.filter(), [&](const IndexedHit& hit) {
        if (hit.t < best.t || best.triangle == kInvalidId) best = hit;
        return true;
      });
      view.name_hits({&best, 1}, &hits[i]);
    });
  }
  void any_hit(QueryCall& call, const QueryRays& rays,
               std::span<std::uint8_t> occluded) const override {
    for_each_item(call, rays, [&](std::size_t i, const Ray& ray, const SceneView& view) {
      std::uint8_t found = 0;
      for_each_hit(view.source(), ray, i, call.filter(), [&](const IndexedHit& /*hit*/) {
        found = 1;
        return false;
      });
      occluded[i] = found;
    });
  }
  void hit_counts(QueryCall& call, const QueryRays& rays,
                  std::span<std::uint32_t> counts) const override {
    for_each_item(call, rays, [&](std::size_t i, const Ray& ray, const SceneView& view) {
      counts[i] = 0;
      for_each_hit(view.source(), ray, i, call.filter(), [&](const IndexedHit& /*hit*/) {
        ++counts[i];
        return true;
      });
    });
  }
  void all_hits(QueryCall& call, const QueryRays& rays, std::size_t most,
                HitRows* rows) const override {
    std::vector<std::vector<Hit>> found(rays.size());
    for_each_item(call, rays, [&](std::size_t i, const Ray& ray, const SceneView& view) {
      std::vector<IndexedHit> hits;
      for_each_hit(view.source(), ray, i, call.filter(), [&](const IndexedHit& hit) {
        hits.push_back(hit);
        return true;
      });
      std::stable_sort(hits.begin(), hits.end(),
                       [](const IndexedHit& a, const IndexedHit& b) { return a.t < b.t; });
      hits.resize(std::min(hits.size(), most));
      found[i].resize(hits.size());
      view.name_hits(View<const IndexedHit>(hits), found[i].data());
    });
    for (std::size_t i = 0; i < found.size(); ++i) {
      rows->hits.insert(rows->hits.end(), found[i].begin(), found[i].end());
      rows->offsets[i + 1] = rows->hits.size();
    }
  }

  void nearest(QueryCall& call, const QueryPoints& points,
               std::span<ClosestPoint> found) const override {
    const std::size_t k = found.size() / points.size();
    for_each_item(call, points, [&](std::size_t i, const QueryPoint& point, const SceneView& view) {
      std::vector<FoundTriangle> best(k);
      find_nearest(view.source(), point, best);
      const std::span<ClosestPoint> to = found.subspan(i * k, k);
      std::transform(best.begin(), best.end(), to.begin(), [&](const FoundTriangle& one) {
        if (one.triangle == kInvalidId) return ClosestPoint{};
        const TriangleSource source = view.source();
        const TriangleRun& run = source.runs[source.run_of(one.triangle)];
        const auto [a, b, c] = run.corners(one.triangle - run.first);
        return closest_point_on(point.at, one.triangle, a, b, c);
      });
      view.name_points(to);
    });
  }
  void signed_distance(QueryCall& call, const QueryPoints& points, InsideRule rule,
                       std::span<double> distances) const override {
    for_each_item(call, points, [&](std::size_t i, const QueryPoint& point, const SceneView& view) {
      FoundTriangle best;
      find_nearest(view.source(), point, {&best, 1});
      const bool below = best.distance > 0 && winds_around(view.source(), point.at, rule);
      distances[i] = below ? -best.distance : best.distance;
    });
  }
  void contains(QueryCall& call, const QueryPoints& points, InsideRule rule,
                std::span<std::uint8_t> inside) const override {
    for_each_item(call, points, [&](std::size_t i, const QueryPoint& point, const SceneView& view) {
      inside[i] = winds_around(view.source(), point.at, rule) ? 1 : 0;
    });
  }
};

}  // namespace

const SceneQueries& by_brute_force() {
  static const QueriesByBruteForce queries;
  return queries;
}

}  // namespace raysheaf
