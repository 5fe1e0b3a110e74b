// The nearest triangles are those that a look at every triangle finds, bit for bit, whatever the
// triangles, the tree and the points.
#include "nearest/nearest.h"

#include "nearest/nearest_support.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

/// Returns how many triangles were found.
std::size_t expect_right(const Soup& soup, const Trees& trees,
                         const std::vector<QueryPoint>& points, const Executor& executor) {
  std::size_t count = 0;
  for (const std::uint32_t k : {1u, 2u, 9u}) {
    std::vector<FoundTriangle> expected;
    for (const QueryPoint& point : points)
      for (const FoundTriangle& one : nearest_by_brute_force(soup, point, k))
        expected.push_back(one);
    for_each_simd_target([&](const char* target) {
      SCOPED_TRACE(target);
      const std::vector<FoundTriangle> found = find_all(executor, trees, points, k);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        const bool same = same_bits(found[i].distance, expected[i].distance) &&
                          found[i].triangle == expected[i].triangle;
        EXPECT_TRUE(same) << "point " << i / k << " of k " << k << ": triangle "
                          << found[i].triangle << " at " << found[i].distance << ", not "
                          << expected[i].triangle << " at " << expected[i].distance;
        if (!same) return;
        count += found[i].triangle != kNoTriangle ? 1 : 0;
        if (found[i].triangle == kNoTriangle) continue;
        const Corners c = trees.scene().corners(found[i]);
        const auto [x, y, z] = soup.corners(static_cast<std::uint32_t>(found[i].triangle));
        EXPECT_TRUE(c.a == x && c.b == y && c.c == z);
      }
    });
  }
  return count;
}

TEST(Nearest, AllShapes) {
  Random random(1);
  const Executor executor(2);
  for (const Shape shape : kShapes) {
    SCOPED_TRACE(static_cast<int>(shape));
    Soup soup = make_soup(shape, 200, random);
    const TriangleSource source = soup.source();
    Trees trees;
    for (const bool fine : {false, true}) {
      trees.build(executor, source, fine);
      const std::vector<QueryPoint> points = any_points(soup, 300, random);
      EXPECT_GT(expect_right(soup, trees, points, executor), 100u);
    }
  }
}

TEST(Nearest, AnyScaleAndPlace) {
  Random random(2);
  const Executor executor(1);
  for (const auto& [scale, offset] : {std::pair{1e-12f, Vec3{}},
                                      {1e17f, Vec3{}},
                                      {1e-30f, Vec3{}},
                                      {1e-3f, Vec3{1e4f, -2e4f, 3e4f}},
                                      {0x1p-140f, Vec3{}}}) {
    SCOPED_TRACE(scale);
    for (const Shape shape : {Shape::kSmall, Shape::kSlivers, Shape::kZeroArea, Shape::kClosed}) {
      Soup soup = make_soup(shape, 150, random, scale, offset);
      std::vector<QueryPoint> points = any_points(soup, 150, random, scale, offset);
      for (QueryPoint& p : points) {
        for (double* x : {&p.at.x, &p.at.y, &p.at.z})
          *x = std::fabs(*x) < kLeastCoordinate ? 0 : std::clamp(*x, -1e18, 1e18);
      }
      Trees trees;
      trees.build(executor, soup.source(), false);
      expect_right(soup, trees, points, executor);
    }
  }
}

/// Triangles move, lose their area and gain it.
/// Points far from the scene, also together with near ones, and near ones next to large triangles.
TEST(Nearest, FromFarAndNextToLargeTriangles) {
  Random random(7);
  const Executor executor(1);
  for (const double distance : {1e2, 1e4, 1e6, 1e9, 1e14}) {
    for (const bool plane : {false, true}) {
      SCOPED_TRACE(testing::Message() << distance << " " << plane);
      Soup soup = make_soup(Shape::kClosed, 200, random);
      const std::vector<QueryPoint> near = any_points(soup, 60, random);
      if (plane) {
        const auto half = static_cast<float>(distance);
        soup.add({-half, -half, -11}, {half, -half, -11}, {half, half, -11});
      }
      const TriangleSource source = soup.source();
      Trees trees;
      trees.build(executor, source, true);
      std::vector<QueryPoint> points = near;
      for (int i = 0; i < 100; ++i) {
        const Vec3 way = random.direction();
        QueryPoint point{distance * (1 + i % 3) * to_point(way)};
        if (i % 5 == 0) point.radius = distance * (1 + i % 3);
        points.insert(points.begin() + random.below(static_cast<std::uint32_t>(points.size())),
                      point);
      }
      EXPECT_GT(expect_right(soup, trees, points, executor), 300u);
      const std::vector<QueryPoint> far(points.end() - 20, points.end());
      expect_right(soup, trees, far, executor);
    }
  }
}

TEST(Nearest, Refits) {
  Random random(3);
  const Executor executor(2);
  Soup soup = make_soup(Shape::kZeroArea, 300, random);
  Trees trees;
  trees.build(executor, soup.source(), false);
  for (int frame = 0; frame < 6; ++frame) {
    for (Vec3& p : soup.positions) p += random.in_box(0.2f);
    for (std::uint32_t i = 0; i < soup.count(); ++i) {
      if (random.below(3) != 0) continue;
      Vec3* const t = &soup.positions[3 * i];
      if (random.below(2) == 0) t[2] = t[1];
      if (random.below(2) == 0) t[1] = t[0];
    }
    trees.refit(executor, soup.source());
    const std::vector<QueryPoint> points = any_points(soup, 200, random);
    EXPECT_GT(expect_right(soup, trees, points, executor), 100u);
  }
}

TEST(Nearest, FewOrNone) {
  Random random(4);
  const Executor executor(2);
  Soup none, one = make_soup(Shape::kSingle, 1, random), flat;
  flat.add({1, 2, 3}, {2, 4, 6}, {3, 6, 9});
  const std::vector<QueryPoint> points = any_points(one, 100, random);
  for (Soup* soup : {&none, &one, &flat}) {
    Trees trees;
    trees.build(executor, soup->source(), false);
    EXPECT_EQ(expect_right(*soup, trees, points, executor) > 0, soup != &none);
    EXPECT_EQ(expect_right(*soup, trees, {}, executor), 0u);
  }
}

/// Points in tiles, as many and as few threads.
TEST(Nearest, ManyPoints) {
  Random random(5);
  Soup soup = make_soup(Shape::kClosed, 2000, random);
  Trees trees;
  trees.build(Executor(1), soup.source(), false);
  const std::vector<QueryPoint> points = any_points(soup, 70'000, random);
  const std::vector<FoundTriangle> few = find_all(Executor(1), trees, points, 3);
  const std::vector<FoundTriangle> many = find_all(Executor(5), trees, points, 3);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < few.size(); ++i)
    wrong +=
        same_bits(few[i].distance, many[i].distance) && few[i].triangle == many[i].triangle ? 0 : 1;
  EXPECT_EQ(wrong, 0u);
  for (std::size_t i = 0; i < points.size(); i += 1999) {
    const auto expected = nearest_by_brute_force(soup, points[i], 3);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(few[3 * i + j].triangle, expected[j].triangle);
  }
}

}  // namespace
}  // namespace raysheaf::test
