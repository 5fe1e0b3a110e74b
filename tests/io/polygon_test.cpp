// Triangulated polygons have two triangles fewer than corners, no overlap, and the polygon's
// winding.
#include "io/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "io/linear.h"

namespace raysheaf::io {
namespace {

Double3 area_vector(const std::vector<Vec3>& p, const std::array<std::uint32_t, 3>& t) {
  return cross(widen(p[t[1]]) - widen(p[t[0]]), widen(p[t[2]]) - widen(p[t[0]]));
}

/// A star around the origin with random radii, seen from a random side.
std::vector<Vec3> star(std::mt19937& random, std::size_t corners) {
  std::uniform_real_distribution<double> unit(0, 1);
  const Double3 x = normalized({unit(random) - 0.5, unit(random), unit(random)}, {1, 0, 0});
  const Double3 y = normalized(cross(x, {unit(random), 0.3, -unit(random)}), {0, 1, 0});
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < corners; ++i) {
    const double angle = 6.283185307179586 * static_cast<double>(i) / static_cast<double>(corners);
    const double radius = 0.2 + unit(random);
    points.push_back(
        narrow(x * (radius * std::cos(angle)) + y * (radius * std::sin(angle)) + Double3{3, 4, 5}));
  }
  return points;
}

/// Expects two triangles fewer than corners, in the polygon's winding, that cover its area once.
void expect_whole(const std::vector<Vec3>& points) {
  const auto triangles = triangulate(points);
  ASSERT_EQ(triangles.size(), points.size() - 2);
  Double3 whole, sum;
  for (std::uint32_t i = 1; i + 1 < points.size(); ++i)
    whole = whole + area_vector(points, {0, i, i + 1});
  double total = 0;
  std::size_t wrong_side = 0;
  for (const auto& t : triangles) {
    sum = sum + area_vector(points, t);
    total += length(area_vector(points, t));
    wrong_side += dot(area_vector(points, t), whole) < -1e-6 ? 1 : 0;
  }
  EXPECT_EQ(wrong_side, 0u) << "winding";
  EXPECT_NEAR(total, length(whole), 1e-4 * length(whole)) << "overlap, with " << points.size();
  EXPECT_NEAR(length(sum - whole), 0, 1e-4 * length(whole));
}

TEST(Polygon, CutsStarsWithoutOverlap) {
  std::mt19937 random(5);
  for (int round = 0; round < 300; ++round) expect_whole(star(random, 4 + random() % 40));
  expect_whole(star(random, 257));
  expect_whole(star(random, 20000));
}

/// A circle, counter-clockwise from angle 0; clockwise for a hole.
std::vector<Vec3> circle(float radius, std::size_t corners, bool hole, Vec3 center = {}) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < corners; ++i) {
    const float angle =
        (hole ? -6.2831853f : 6.2831853f) * static_cast<float>(i) / static_cast<float>(corners);
    points.push_back(
        {center.x + radius * std::cos(angle), center.y + radius * std::sin(angle), center.z});
  }
  return points;
}

/// Connects `hole` to `border` by a pair of edges between the first corner of each.
std::vector<Vec3> hung(const std::vector<Vec3>& border, const std::vector<Vec3>& hole) {
  std::vector<Vec3> all = border;
  all.push_back(border[0]);
  all.insert(all.end(), hole.begin(), hole.end());
  all.push_back(hole[0]);
  return all;
}

TEST(Polygon, CutsRingsThatAreHungOnEdgesThereAndBack) {
  std::mt19937 random(6);
  for (int round = 0; round < 100; ++round) {
    std::vector<Vec3> ring =
        hung(circle(2, 3 + random() % 60, false), circle(0.9f, 3 + random() % 60, true));
    // From any corner, and from the other side.
    std::rotate(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(random() % ring.size()),
                ring.end());
    if (round % 2 == 0) std::reverse(ring.begin(), ring.end());
    expect_whole(ring);
  }
  // Two holes at the same corner, where they meet; and one that touches the border from inside.
  const std::vector<Vec3> square = {{4, 4, 0}, {-4, 4, 0}, {-4, -4, 0}, {4, -4, 0}};
  expect_whole(hung(hung(square, circle(1, 8, true, {1, -2, 0})), circle(1, 8, true, {-2, 1, 0})));
  expect_whole({{0, 0, 0},
                {1, 1, 0},
                {-1, 1, 0},
                {0, 0, 0},
                {-4, 4, 0},
                {-4, -4, 0},
                {4, -4, 0},
                {4, 4, 0}});
  expect_whole({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 0, 0}, {0, 4, 0}});
}

/// A comb as high as it is wide: every corner sees few others.
TEST(Polygon, CutsACombOfManyTeeth) {
  std::vector<Vec3> comb;
  for (int tooth = 0; tooth < 5000; ++tooth) {
    const float x = static_cast<float>(tooth);
    comb.push_back({x, 1, 0});
    comb.push_back({x + 0.5f, 5000, 0});
  }
  comb.push_back({5000, 0, 0});
  comb.push_back({0, 0, 0});
  expect_whole(comb);
}

TEST(Polygon, MakesFansOfConvexOnes) {
  const std::vector<Vec3> square = {{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0}};
  const std::vector<std::array<std::uint32_t, 3>> fan = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(triangulate(square), fan);
}

TEST(Polygon, HasAnAnswerForEveryInput) {
  std::mt19937 random(9);
  EXPECT_TRUE(triangulate({}).empty());
  EXPECT_TRUE(triangulate({{0, 0, 0}, {1, 0, 0}}).empty());
  for (const std::size_t corners : {3u, 4u, 5u, 9u, 100u, 256u, 5000u}) {
    for (const float scale : {0.0f, 1e-30f, 1.0f, 1e30f}) {
      std::vector<Vec3> points;
      // Corners on a coarse grid: repeated corners, spikes, crossings.
      for (std::size_t i = 0; i < corners; ++i) {
        points.push_back({scale * static_cast<float>(random() % 3),
                          scale * static_cast<float>(random() % 3), 0});
      }
      const auto triangles = triangulate(points);
      ASSERT_EQ(triangles.size(), corners - 2);
      for (const auto& t : triangles) {
        for (const std::uint32_t v : t) ASSERT_LT(v, corners);
      }
    }
  }
}

}  // namespace
}  // namespace raysheaf::io
