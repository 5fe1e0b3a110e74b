// Triangles of a polygon: as many as its corners less two, no overlap, the same winding.
#include "io/polygon.h"

#include <gtest/gtest.h>

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

TEST(Polygon, CutsStarsWithoutOverlap) {
  std::mt19937 random(5);
  for (int round = 0; round < 300; ++round) {
    const std::size_t corners = 4 + random() % 40;
    const std::vector<Vec3> points = star(random, corners);
    const auto triangles = triangulate(points);
    ASSERT_EQ(triangles.size(), corners - 2);
    Double3 whole, sum;
    for (std::uint32_t i = 1; i + 1 < corners; ++i)
      whole = whole + area_vector(points, {0, i, i + 1});
    double total = 0;
    for (const auto& t : triangles) {
      sum = sum + area_vector(points, t);
      total += length(area_vector(points, t));
      EXPECT_GE(dot(area_vector(points, t), whole), -1e-6) << "winding";
    }
    EXPECT_NEAR(total, length(whole), 1e-4 * length(whole)) << "overlap, with " << corners;
    EXPECT_NEAR(length(sum - whole), 0, 1e-4);
  }
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
      // A grid of few places: repeated corners, spikes, crossings.
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
