// The distance between a point and a triangle against arithmetic of 113 bits, and its promises.
#include "nearest/point_triangle_body.h"

#include "lab/verify/point_judge.h"
#include "nearest/nearest_support.h"

namespace raysheaf::test {
namespace {

/// Off by so many parts of distance and longest edge together.
double error_of(Point p, Point a, Point b, Point c) {
  const TriangleDistance found = distance_to_triangle(p, a, b, c);
  const double exact = checks::wide_distance(p, a, b, c);
  const double size = exact + checks::longest_edge(a, b, c);
  return size > 0 ? std::fabs(std::sqrt(found.squared) - exact) / size : std::sqrt(found.squared);
}

TEST(PointTriangle, IsNearTheExactDistance) {
  Random random(1);
  double worst = 0;
  for (const auto& [scale, offset] : {std::pair{1.0f, Vec3{}},
                                      {1e-12f, Vec3{}},
                                      {1e15f, Vec3{}},
                                      {1.0f, Vec3{1e5f, -1e5f, 3e4f}}}) {
    for (const Shape shape : kShapes) {
      const Soup soup = make_soup(shape, 300, random, scale, offset);
      for (int i = 0; i < 6000; ++i) {
        const Point p = any_point(soup, random, scale, offset).at;
        const auto [a, b, c] = soup.corners(random.below(soup.count()));
        worst = std::max(worst, error_of(p, to_point(a), to_point(b), to_point(c)));
      }
    }
  }
  RecordProperty("worst", std::to_string(std::log2(worst)));
  EXPECT_LT(worst, 0x1p-48) << "2^" << std::log2(worst);
}

/// As flat as floats allow: a corner a few ulp off the edge, and points on, near and above it.
TEST(PointTriangle, Needles) {
  Random random(2);
  double worst = 0;
  for (int i = 0; i < 200'000; ++i) {
    const Vec3 a = random.in_box(1), b = random.in_box(1);
    Vec3 c = a + (b - a) * random.unit();
    c.x = std::nextafter(c.x, random.below(2) == 0 ? 2.0f : -2.0f);
    const Vec3 q = a + (b - a) * random.unit();
    const double far = std::ldexp(1.0, -static_cast<int>(random.below(60)));
    const Point p = to_point(q) + far * to_point(random.direction());
    worst = std::max(worst, error_of(p, to_point(a), to_point(b), to_point(c)));
  }
  RecordProperty("worst", std::to_string(std::log2(worst)));
  EXPECT_LT(worst, 0x1p-48) << "2^" << std::log2(worst);
}

/// For integers up to 60, the exact distance to a corner is the root of an integer.
TEST(PointTriangle, CornersAreExact) {
  Random random(3);
  const auto integer = [&] { return static_cast<float>(random.below(121)) - 60; };
  const auto point = [&] { return Vec3{integer(), integer(), integer()}; };
  for (int i = 0; i < 100'000; ++i) {
    const Point a = to_point(point()), b = to_point(point()), c = to_point(point());
    EXPECT_EQ(distance_to_triangle(a, a, b, c).squared, 0);
    EXPECT_EQ(distance_to_triangle(b, a, b, c).squared, 0);
    EXPECT_EQ(distance_to_triangle(c, a, b, c).squared, 0);
    const Point p = to_point(point()), d = p - a;
    EXPECT_EQ(distance_to_triangle(p, a, a, a).squared, dot(d, d));
    const double least = std::min({dot(d, d), dot(p - b, p - b), dot(p - c, p - c)});
    EXPECT_LE(distance_to_triangle(p, a, b, c).squared, least);
  }
}

/// However the corners come, edges and corners are as far: neighbours tie.
TEST(PointTriangle, NeighboursHaveTheirEdgesDistance) {
  Random random(4);
  int on_edges = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Point a = to_point(random.in_box(1)), b = to_point(random.in_box(1));
    const Point c = to_point(random.in_box(1)), e = to_point(random.in_box(1));
    const Point p = to_point(random.in_box(3));
    const double edge = distance_to_triangle(p, a, b, b).squared;
    EXPECT_EQ(distance_to_triangle(p, b, a, a).squared, edge);
    const double one = distance_to_triangle(p, a, b, c).squared;
    const double other = distance_to_triangle(p, b, a, e).squared;
    EXPECT_LE(one, edge);
    EXPECT_LE(other, edge);
    on_edges += one == edge && other == edge ? 1 : 0;
  }
  EXPECT_GT(on_edges, 5000);
}

/// A box is never farther than what is in it, computed in the same order.
TEST(PointTriangle, BoxesBoundIt) {
  Random random(5);
  for (const Shape shape : kShapes) {
    const Soup soup = make_soup(shape, 300, random);
    for (int i = 0; i < 20'000; ++i) {
      const Point p = any_point(soup, random).at;
      const auto t = soup.corners(random.below(soup.count()));
      const Point low = to_point(min(min(t[0], t[1]), t[2]));
      const Point high = to_point(max(max(t[0], t[1]), t[2]));
      const auto along = [](double x, double from, double to) {
        return std::max({from - x, x - to, 0.0});
      };
      const Point box{along(p.x, low.x, high.x), along(p.y, low.y, high.y),
                      along(p.z, low.z, high.z)};
      EXPECT_GE(distance_to_triangle(p, to_point(t[0]), to_point(t[1]), to_point(t[2])).squared,
                dot(box, box));
    }
  }
}

/// The weights are those of a point that is as far.
TEST(PointTriangle, WeightsNameThePoint) {
  Random random(6);
  for (const Shape shape : kShapes) {
    const Soup soup = make_soup(shape, 300, random);
    for (int i = 0; i < 5000; ++i) {
      const Point p = any_point(soup, random).at;
      const auto t = soup.corners(random.below(soup.count()));
      const Point a = to_point(t[0]), b = to_point(t[1]), c = to_point(t[2]);
      const TriangleDistance found = distance_to_triangle(p, a, b, c);
      EXPECT_TRUE(found.u >= 0 && found.v >= 0 && found.u + found.v <= 1);
      const Point r = p - point_of_weights(found.u, found.v, a, b, c);
      const double size =
          std::sqrt(dot(p, p)) + std::sqrt(dot(a, a)) + checks::longest_edge(a, b, c);
      EXPECT_NEAR(std::sqrt(dot(r, r)), std::sqrt(found.squared), 0x1p-48 * size);
    }
  }
}

}  // namespace
}  // namespace raysheaf::test
