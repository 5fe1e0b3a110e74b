// Every ray and every point with every triangle of the instances that the mask shows, each placed
// where it is met: the reference for all other ways, for any number of triangles.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <tuple>
#include <vector>

#include "api/query_call.h"
#include "api/scene_queries.h"
#include "exec/stopwatch.h"
#include "intersect/indexed_hit.h"
#include "intersect/triangle_body.h"
#include "nearest/closest_body.h"
#include "nearest/crossing_body.h"

namespace raysheaf {
namespace {

/// Rays or points of a task, which a triangle meets one after the other.
constexpr std::size_t kBruteItems = 16;
/// Triangles between two looks at whether the caller has cancelled.
constexpr std::uint32_t kBruteCheck = 4096;

/// Calls `take(number, prim, corners)`, which says whether to go on, for the triangles of instances
/// that the query sees, in the order of (geom_id, inst_id, prim_id).
template <class Take>
void for_each_triangle(const QueryCall& call, const Take& take) {
  const SceneRuns& scene = call.scene();
  for (std::uint32_t number = 0; number < scene.notes.size(); ++number) {
    if ((scene.notes[number].mask & call.options().mask) == 0) continue;
    const InstanceCorners corners(scene.placed.instances()[number]);
    for (std::uint32_t prim = 0; prim < corners.count(); ++prim) {
      if (prim % kBruteCheck == 0) call.executor().check();
      if (!take(number, prim, corners(prim))) return;
    }
  }
}

/// Calls `answer(begin, some)` for all items, some at a time.
template <class Item, class Answer>
void for_each_items(QueryCall& call, const Source<Item>& items, const Answer& answer) {
  Buffer<Item> room;
  const View<const Item> all = call.take_all(items, &room);
  const Stopwatch watch;
  call.executor().for_each((all.size + kBruteItems - 1) / kBruteItems, 1, [&](std::size_t block) {
    const std::size_t begin = block * kBruteItems;
    answer(begin, all.slice(begin, std::min(kBruteItems, all.size - begin)));
  });
  call.add_time(&QueryReport::trace_ms, watch.ms());
  QueryReport* const report = call.report();
  if (report == nullptr) return;
  if (call.options().count_tests)
    report->triangle_tests = all.size * visible_triangles(call.scene(), call.options().mask);
  report->plan = {kByBruteForce};
}

/// Calls `take(i, hit)`, which says whether ray i goes on, for its hits that count, in the order of
/// (geom_id, inst_id, prim_id). A ray with a time meets instances where they are then.
template <class Take>
void for_each_hit(QueryCall& call, const QueryRays& rays, const Take& take) {
  const HitChoice choice = choice_of_hits(call.options());
  const std::span<const float> times = call.options().ray_times;
  const SceneRuns& scene = call.scene();
  for_each_items(call, rays, [&](std::size_t begin, View<const Ray> some) {
    std::array<RaySetup, kBruteItems> setups;
    std::array<InstanceCorners, kBruteItems> moved;  // of an instance, at the rays' times
    std::transform(some.begin(), some.end(), setups.begin(), make_ray_setup);
    std::uint32_t going = (1u << some.size) - 1;
    for_each_triangle(
        call, [&](std::uint32_t number, std::uint32_t prim, const std::array<Vec3, 3>& corners) {
          const PlacedInstance& instance = scene.placed.instances()[number];
          const bool moves = !times.empty() && instance.moves();
          for (std::size_t k = 0; k < some.size && moves && prim == 0; ++k)
            moved[k] = InstanceCorners(instance, times[begin + k]);
          for (std::uint32_t left = going; left != 0; left &= left - 1) {
            const auto k = static_cast<std::uint32_t>(std::countr_zero(left));
            const auto [a, b, c] = moves ? moved[k](prim) : corners;
            const bool mirrored = moves ? moved[k].mirrored() : instance.mirrored;
            TriangleHit hit;
            if (!intersect_triangle(setups[k], a, b, c, &hit)) continue;
            const auto ray = static_cast<std::uint32_t>(begin) + k;
            if (choice.sees(ray, scene.notes[number].mask, scene.notes[number].world) &&
                choice.takes(ray, {instance.inst_id, prim}, mirrored, hit.front) &&
                !take(ray, Hit{hit.t, hit.u, hit.v, prim, instance.geom_id, instance.inst_id}))
              going &= ~(1u << k);
          }
          return going != 0;
        });
  });
}

/// A triangle of an instance, by its number in the scene, and its distance from a point.
struct NamedTriangle {
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t instance = kInvalidId, prim = kInvalidId;
};
bool is_less(const NamedTriangle& a, const NamedTriangle& b) {
  return std::tie(a.distance, a.instance, a.prim) < std::tie(b.distance, b.instance, b.prim);
}

/// Writes the nearest triangles of each point, sorted, `k` for each. `begin`: the number of
/// points[0] among all.
void find_nearest(const QueryCall& call, std::size_t begin, View<const QueryPoint> points,
                  std::size_t k, View<NamedTriangle> best) {
  const ItemWorlds worlds = worlds_of(call.options());
  for_each_triangle(
      call, [&](std::uint32_t number, std::uint32_t prim, const std::array<Vec3, 3>& corners) {
        for (std::size_t i = 0; i < points.size; ++i) {
          if (!worlds.meet(begin + i, call.scene().notes[number].world)) continue;
          const TriangleDistance found = distance_to_triangle(
              points[i].at, to_point(corners[0]), to_point(corners[1]), to_point(corners[2]));
          const NamedTriangle one{std::sqrt(found.squared), number, prim};
          NamedTriangle* const first = best.data + i * k;
          NamedTriangle* const last = first + k - 1;
          if (!(one.distance <= points[i].radius) || !is_less(one, *last)) continue;
          NamedTriangle* const place = std::upper_bound(first, last, one, is_less);
          std::move_backward(place, last, last + 1);
          *place = one;
        }
        return true;
      });
}

ClosestPoint named_point(const SceneRuns& scene, Point p, const NamedTriangle& found) {
  if (found.prim == kInvalidId) return {};
  const PlacedInstance& instance = scene.placed.instances()[found.instance];
  const auto [a, b, c] = InstanceCorners(instance)(found.prim);
  ClosestPoint point = closest_point_on(p, found.prim, a, b, c);
  point.geom_id = instance.geom_id;
  point.inst_id = instance.inst_id;
  return point;
}

/// Bit i: the surface winds around point i, by all six rays.
std::uint32_t winds_around(const QueryCall& call, std::size_t begin, View<const QueryPoint> points,
                           InsideRule rule) {
  const ItemWorlds worlds = worlds_of(call.options());
  std::array<std::int64_t, kBruteItems> winding{};
  std::array<std::array<std::int64_t, kAxisRays>, kBruteItems> number{};
  for_each_triangle(call, [&](std::uint32_t instance, std::uint32_t /*prim*/,
                              const std::array<Vec3, 3>& corners) {
    const WorldId world = call.scene().notes[instance].world;
    const Point a = to_point(corners[0]), b = to_point(corners[1]), c = to_point(corners[2]);
    for (std::size_t i = 0; i < points.size; ++i)
      for (int ray = 0; ray < kAxisRays && worlds.meet(begin + i, world); ++ray) {
        const int crossed = crossing(points[i].at, a, b, c, ray);
        winding[i] += crossed;
        number[i][static_cast<std::size_t>(ray)] += std::abs(crossed);
      }
    return true;
  });
  std::uint32_t inside = 0;
  for (std::size_t i = 0; i < points.size; ++i) {
    const auto odd = std::count_if(number[i].begin(), number[i].end(),
                                   [](std::int64_t n) { return n % 2 != 0; });
    const std::int64_t votes = rule == InsideRule::kNonZero ? std::abs(winding[i]) : odd;
    inside |= (2 * votes > kAxisRays ? 1u : 0u) << i;
  }
  return inside;
}

class QueriesByBruteForce final : public SceneQueries {
 public:
  void closest_hit(QueryCall& call, const QueryRays& rays, std::span<Hit> hits) const override {
    std::fill(hits.begin(), hits.end(), Hit());
    for_each_hit(call, rays, [&](std::size_t i, const Hit& hit) {
      if (hit.t < hits[i].t) hits[i] = hit;
      return true;
    });
  }
  void any_hit(QueryCall& call, const QueryRays& rays,
               std::span<std::uint8_t> occluded) const override {
    std::fill(occluded.begin(), occluded.end(), std::uint8_t{0});
    for_each_hit(call, rays, [&](std::size_t i, const Hit& /*hit*/) {
      occluded[i] = 1;
      return false;
    });
  }
  void hit_counts(QueryCall& call, const QueryRays& rays,
                  std::span<std::uint32_t> counts) const override {
    std::fill(counts.begin(), counts.end(), 0u);
    for_each_hit(call, rays, [&](std::size_t i, const Hit& /*hit*/) {
      ++counts[i];
      return true;
    });
  }
  void all_hits(QueryCall& call, const QueryRays& rays, std::size_t most,
                HitRows* rows) const override {
    std::vector<std::vector<Hit>> found(rays.size());
    for_each_hit(call, rays, [&](std::size_t i, const Hit& hit) {
      found[i].push_back(hit);
      return true;
    });
    for (std::size_t i = 0; i < found.size(); ++i) {
      std::sort(found[i].begin(), found[i].end(), is_before);
      found[i].resize(std::min(found[i].size(), most));
      rows->hits.insert(rows->hits.end(), found[i].begin(), found[i].end());
      rows->offsets[i + 1] = rows->hits.size();
    }
  }

  void nearest(QueryCall& call, const QueryPoints& points,
               std::span<ClosestPoint> found) const override {
    const std::size_t k = found.size() / points.size();
    for_each_items(call, points, [&](std::size_t begin, View<const QueryPoint> some) {
      std::vector<NamedTriangle> best(some.size * k);
      find_nearest(call, begin, some, k, best);
      for (std::size_t i = 0; i < best.size(); ++i)
        found[begin * k + i] = named_point(call.scene(), some[i / k].at, best[i]);
    });
  }
  void signed_distance(QueryCall& call, const QueryPoints& points, InsideRule rule,
                       std::span<double> distances) const override {
    for_each_items(call, points, [&](std::size_t begin, View<const QueryPoint> some) {
      std::vector<NamedTriangle> best(some.size);
      find_nearest(call, begin, some, 1, best);
      const std::uint32_t inside = winds_around(call, begin, some, rule);
      for (std::size_t i = 0; i < some.size; ++i) {
        const double distance = best[i].distance;
        distances[begin + i] = distance > 0 && (inside >> i & 1) != 0 ? -distance : distance;
      }
    });
  }
  void contains(QueryCall& call, const QueryPoints& points, InsideRule rule,
                std::span<std::uint8_t> inside) const override {
    for_each_items(call, points, [&](std::size_t begin, View<const QueryPoint> some) {
      const std::uint32_t bits = winds_around(call, begin, some, rule);
      for (std::size_t i = 0; i < some.size; ++i)
        inside[begin + i] = static_cast<std::uint8_t>(bits >> i & 1);
    });
  }
};

}  // namespace

const SceneQueries& by_brute_force() {
  static const QueriesByBruteForce queries;
  return queries;
}

}  // namespace raysheaf
