#include "geom/miniball.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace raysheaf {
namespace {

using Points = std::vector<Vec3>;

Sphere ball(const Points& points) {
  return miniball({points.data(), points.size()});
}

double distance(Vec3 a, Vec3 b) {
  return std::hypot(static_cast<double>(a.x) - b.x, static_cast<double>(a.y) - b.y,
                    static_cast<double>(a.z) - b.z);
}

void expect_holds(const Sphere& sphere, const Points& points) {
  for (const Vec3 p : points) ASSERT_LE(distance(p, sphere.center), sphere.radius);
}

/// A lower bound of the radius by a method unrelated to Gärtner's: M. Badoiu and K. L. Clarkson,
/// "Smaller core-sets for balls", 2003. A walk towards the farthest point converges to the centre.
double slow_radius(const Points& points, int steps) {
  double c[3] = {points[0].x, points[0].y, points[0].z}, reach = 0;
  double best = std::numeric_limits<double>::infinity();
  for (int i = 1; i <= steps; ++i) {
    Vec3 far;
    reach = -1;
    for (const Vec3 p : points) {
      const double d = std::hypot(p.x - c[0], p.y - c[1], p.z - c[2]);
      if (d > reach) reach = d, far = p;
    }
    best = std::min(best, reach);
    c[0] += (far.x - c[0]) / (i + 1), c[1] += (far.y - c[1]) / (i + 1),
        c[2] += (far.z - c[2]) / (i + 1);
  }
  return best;
}

/// A sphere is the smallest if and only if its centre lies in the convex hull of the points on its
/// boundary. From a centre outside the hull, some direction has all of these points behind it: this
/// searches for one at random.
void expect_least(const Sphere& sphere, const Points& points, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Points support;
  for (const Vec3 p : points) {
    if (distance(p, sphere.center) >= sphere.radius * (1 - 1e-6)) support.push_back(p);
  }
  ASSERT_FALSE(support.empty());
  for (int i = 0; i < 200; ++i) {
    const double d[3] = {normal(random), normal(random), normal(random)};
    const double size = std::hypot(d[0], d[1], d[2]);
    double most = -1;
    for (const Vec3 p : support) {
      const double along = ((static_cast<double>(p.x) - sphere.center.x) * d[0] +
                            (static_cast<double>(p.y) - sphere.center.y) * d[1] +
                            (static_cast<double>(p.z) - sphere.center.z) * d[2]) /
                           size;
      most = std::max(most, along);
    }
    ASSERT_GE(most, -2e-3 * sphere.radius);
  }
}

Vec3 random_point(std::mt19937& random, float scale) {
  std::uniform_real_distribution<float> u(-scale, scale);
  return {u(random), u(random), u(random)};
}

TEST(Miniball, NothingIsEmpty) {
  EXPECT_LT(ball({}).radius, 0);
}

TEST(Miniball, OnePointIsItself) {
  const Sphere s = ball({{3, -4, 5}});
  EXPECT_EQ(s.center, (Vec3{3, -4, 5}));
  EXPECT_EQ(s.radius, 0);
}

TEST(Miniball, TwoPointsAreADiameter) {
  const Sphere s = ball({{1, 0, 0}, {3, 0, 0}});
  EXPECT_EQ(s.center, (Vec3{2, 0, 0}));
  EXPECT_NEAR(s.radius, 1, 1e-6);
}

TEST(Miniball, KnownBalls) {
  const float third = std::sqrt(3.0f) / 2;
  EXPECT_NEAR(ball({{1, 0, 0}, {-0.5f, third, 0}, {-0.5f, -third, 0}}).radius, 1, 1e-6);
  EXPECT_NEAR(ball({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}).radius, std::sqrt(3.0),
              1e-6);
  EXPECT_NEAR(ball({{-5, 0, 0}, {5, 0, 0}, {0, 1, 0}, {0, 0, 2}}).radius, 5, 1e-5);
}

TEST(Miniball, RandomBallsAreLeast) {
  std::mt19937 random(1);
  for (int round = 0; round < 300; ++round) {
    Points points(1 + random() % 40);
    for (Vec3& p : points) p = random_point(random, 1);
    const Sphere s = ball(points);
    expect_holds(s, points);
    if (points.size() > 1) expect_least(s, points, random);
  }
}

TEST(Miniball, AgreesWithASlowMethod) {
  std::mt19937 random(2);
  for (int round = 0; round < 30; ++round) {
    Points points(3 + random() % 60);
    for (Vec3& p : points) p = random_point(random, 10);
    const double slow = slow_radius(points, 3000), fast = ball(points).radius;
    EXPECT_LE(fast, slow * (1 + 1e-6));
    EXPECT_GE(fast, slow * (1 - 2e-2));
  }
}

TEST(Miniball, DuplicatesChangeNothing) {
  std::mt19937 random(3);
  Points points(10);
  for (Vec3& p : points) p = random_point(random, 1);
  const float once = ball(points).radius;
  for (int i = 0; i < 500; ++i) points.push_back(points[random() % 10]);
  std::shuffle(points.begin(), points.end(), random);
  EXPECT_NEAR(ball(points).radius, once, 1e-6);
  expect_holds(ball(points), points);
  EXPECT_EQ(ball(Points(1000, Vec3{7, 7, 7})).radius, 0);
}

TEST(Miniball, CollinearPoints) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> u(-1, 1);
  Points points;
  for (int i = 0; i < 200; ++i) {
    const float t = u(random);
    points.push_back({0.1f + 0.3f * t, 0.2f - 0.7f * t, 0.5f * t});
  }
  points.push_back({0.4f, -0.5f, 0.5f});
  points.push_back({-0.2f, 0.9f, -0.5f});
  const Sphere s = ball(points);
  expect_holds(s, points);
  EXPECT_NEAR(s.radius, distance({0.4f, -0.5f, 0.5f}, {-0.2f, 0.9f, -0.5f}) / 2, 1e-5);
}

TEST(Miniball, CosphericalAndCocircularPoints) {
  std::mt19937 random(5);
  Points sphere, circle;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 d = normalized(random_point(random, 1));
    sphere.push_back(d * 2 + Vec3{10, 20, 30});
    const float angle = static_cast<float>(i) * 2 * std::numbers::pi_v<float> / 2000;
    circle.push_back({std::cos(angle), 4, std::sin(angle)});
  }
  expect_holds(ball(sphere), sphere);
  EXPECT_NEAR(ball(sphere).radius, 2, 1e-5);
  expect_holds(ball(circle), circle);
  EXPECT_NEAR(ball(circle).radius, 1, 1e-6);
}

TEST(Miniball, GridsOfManyTies) {
  Points points;
  for (int i = 0; i < 1000; ++i) {
    points.push_back(
        {static_cast<float>(i % 10), static_cast<float>(i / 10 % 10), static_cast<float>(i / 100)});
  }
  const Sphere s = ball(points);
  expect_holds(s, points);
  EXPECT_NEAR(s.radius, 4.5 * std::sqrt(3.0), 1e-5);
}

TEST(Miniball, AnyScaleAndAnyPlace) {
  std::mt19937 random(6);
  for (const float scale : {1e-38f, 1e-30f, 1e-10f, 1e10f, 1e30f}) {
    Points points(50);
    for (Vec3& p : points) p = random_point(random, scale);
    const Sphere s = ball(points);
    expect_holds(s, points);
    expect_least(s, points, random);
  }
  Points far(50);
  for (Vec3& p : far) p = random_point(random, 1) + Vec3{1e6f, -1e6f, 1e6f};
  expect_holds(ball(far), far);
  EXPECT_LT(ball(far).radius, 2);
}

TEST(Miniball, AlmostFlatPoints) {
  std::mt19937 random(7);
  for (float thickness = 1; thickness > 1e-20f; thickness *= 0.1f) {
    Points points(100);
    for (Vec3& p : points) p = random_point(random, 1) * Vec3{1, thickness, thickness};
    const Sphere s = ball(points);
    expect_holds(s, points);
    EXPECT_LE(s.radius, slow_radius(points, 300) * (1 + 1e-6));
  }
}

}  // namespace
}  // namespace raysheaf
