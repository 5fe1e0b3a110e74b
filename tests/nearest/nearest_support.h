// Points that no surveyor would take, and what a look at every triangle says of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "dual/dual_scenes.h"
#include "nearest/crossing_body.h"
#include "nearest/inside.h"
#include "nearest/point_triangle_body.h"

namespace raysheaf::test {

/// A number of 113 bits: GCC's and Clang's, or `long double` where that has as many, as on aarch64.
#ifdef __SIZEOF_FLOAT128__
__extension__ using Wide = __float128;
#else
using Wide = long double;
static_assert(std::numeric_limits<Wide>::digits == 113);
#endif

using PointList = InPlace<QueryPoint>;

/// On corners, edges and faces, near them, at lattice points, anywhere and far away.
inline QueryPoint any_point(const Soup& soup, Random& random, float scale = 1, Vec3 offset = {}) {
  const auto t = soup.corners(random.below(soup.count()));
  QueryPoint point;
  const auto at = [&](Vec3 p) { point.at = to_point(p); };
  switch (random.below(8)) {
    case 0:
      at(t[random.below(3)]);
      break;
    case 1:
      at((t[0] + t[1]) * 0.5f);
      break;
    case 2:
      at(t[0] * 0.25f + t[1] * 0.25f + t[2] * 0.5f);
      break;
    case 3:
      at(lattice_point(random) * scale + offset);
      break;
    case 4:
      at(random.in_box(1e4f) * scale + offset);
      break;
    case 5:  // no float
      at(t[random.below(3)]);
      point.at = point.at + (double{scale} * 1e-10) * to_point(random.in_box(1));
      break;
    default:
      at(random.in_box(14) * scale + offset);
      break;
  }
  if (random.below(4) == 0) point.radius = double{scale} * static_cast<double>(random.unit()) * 3;
  if (random.below(50) == 0) point.radius = 0;
  return point;
}

inline std::vector<QueryPoint> any_points(const Soup& soup, std::size_t count, Random& random,
                                          float scale = 1, Vec3 offset = {}) {
  std::vector<QueryPoint> points;
  while (points.size() < count) points.push_back(any_point(soup, random, scale, offset));
  return points;
}

inline double distance_of(Point p, const Soup& soup, std::uint32_t i) {
  const auto [a, b, c] = soup.corners(i);
  return std::sqrt(distance_to_triangle(p, to_point(a), to_point(b), to_point(c)).squared);
}

/// The k nearest, the nearest first.
inline std::vector<FoundTriangle> nearest_by_brute_force(const Soup& soup, const QueryPoint& point,
                                                         std::size_t k) {
  std::vector<FoundTriangle> all;
  for (std::uint32_t i = 0; i < soup.count(); ++i) {
    const double distance = distance_of(point.at, soup, i);
    if (distance <= point.radius) all.push_back({distance, i});
  }
  std::sort(all.begin(), all.end(), is_nearer);
  all.resize(k);
  return all;
}

struct Sums {
  int winding = 0, number = 0;
};

inline Sums sums_by_brute_force(const Soup& soup, Point p, int ray) {
  Sums sums;
  for (std::uint32_t i = 0; i < soup.count(); ++i) {
    const auto [a, b, c] = soup.corners(i);
    const int crossed = crossing(p, to_point(a), to_point(b), to_point(c), ray);
    sums.winding += crossed;
    sums.number += std::abs(crossed);
  }
  return sums;
}

/// By all six rays.
inline bool inside_by_brute_force(const Soup& soup, Point p, InsideRule rule) {
  int winding = 0, odd = 0;
  for (int ray = 0; ray < kAxisRays; ++ray) {
    const Sums sums = sums_by_brute_force(soup, p, ray);
    winding += sums.winding;
    odd += sums.number % 2;
  }
  return 2 * (rule == InsideRule::kNonZero ? std::abs(winding) : odd) > kAxisRays;
}

/// The tree, and what it leaves out.
struct Trees {
  ObjectTree solid, thin;

  void build(const Executor& executor, const TriangleSource& source, bool fine) {
    if (fine)
      build_fine_object_tree(executor, source, &solid);
    else
      build_object_tree(executor, source, &solid);
    build_thin_tree(executor, source, solid, &thin);
  }
  void refit(const Executor& executor, const TriangleSource& source) {
    if (!refit_object_tree(executor, source, MovedTriangles::everything(), &solid))
      build_object_tree(executor, source, &solid);
    build_thin_tree(executor, source, solid, &thin);
  }
  [[nodiscard]] NearestScene scene() const { return {&solid, &thin}; }
};

inline std::vector<FoundTriangle> find_all(const Executor& executor, const Trees& trees,
                                           const std::vector<QueryPoint>& points, std::uint32_t k) {
  std::vector<FoundTriangle> all(points.size() * k);
  find_nearest(executor, trees.scene(), PointList(points), k, [&](const NearestTile& tile) {
    std::copy(tile.found.begin(), tile.found.end(),
              all.begin() + static_cast<std::ptrdiff_t>(tile.begin * k));
  });
  return all;
}

inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

}  // namespace raysheaf::test
