#include "api/points_brute.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "nearest/crossing_body.h"
#include "nearest/point_triangle_body.h"

namespace raysheaf::brute {
namespace {

/// Points a task.
constexpr std::size_t kPointGrain = 16;

/// Calls `take(number, a, b, c)` for all triangles.
template <class Take>
void for_each_triangle(const TriangleSource& source, const Take& take) {
  for (const TriangleRun& run : source.runs) {
    for (std::uint32_t i = 0; i < run.count; ++i) {
      const auto [a, b, c] = run.corners(i);
      take(run.first + i, to_point(a), to_point(b), to_point(c));
    }
  }
}

}  // namespace

void nearest(const Executor& executor, const TriangleSource& source, View<const QueryPoint> points,
             std::size_t k, View<FoundTriangle> found) {
  executor.for_each(points.size, kPointGrain, [&](std::size_t i) {
    executor.check();
    FoundTriangle* const best = found.data + i * k;
    std::fill_n(best, k, FoundTriangle{});
    const QueryPoint& point = points[i];
    for_each_triangle(source, [&](std::uint32_t number, Point a, Point b, Point c) {
      const double distance = std::sqrt(distance_to_triangle(point.at, a, b, c).squared);
      const FoundTriangle one{distance, number};
      if (!(distance <= point.radius) || !is_nearer(one, best[k - 1])) return;
      FoundTriangle* const place = std::upper_bound(best, best + k, one, is_nearer);
      std::move_backward(place, best + k - 1, best + k);
      *place = one;
    });
  });
}

void contains(const Executor& executor, const TriangleSource& source, View<const QueryPoint> points,
              InsideRule rule, View<std::uint8_t> inside) {
  executor.for_each(points.size, kPointGrain, [&](std::size_t i) {
    executor.check();
    std::int64_t winding = 0, odd = 0;
    for (int ray = 0; ray < kAxisRays; ++ray) {
      std::int64_t number = 0;
      for_each_triangle(source, [&](std::uint32_t /*number*/, Point a, Point b, Point c) {
        const int crossed = crossing(points[i].at, a, b, c, ray);
        winding += crossed;
        number += std::abs(crossed);
      });
      odd += number % 2;
    }
    const std::int64_t sum = rule == InsideRule::kNonZero ? std::abs(winding) : odd;
    inside[i] = 2 * sum > kAxisRays ? 1 : 0;
  });
}

}  // namespace raysheaf::brute
