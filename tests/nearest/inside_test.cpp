// Compares `contains` with a test of every triangle in integers, and with shapes of known inside.
#include "nearest/inside.h"

#include "nearest/nearest_support.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

/// Returns how many are inside.
std::size_t expect_right(Soup& soup, const std::vector<QueryPoint>& points, InsideRule rule,
                         const Executor& executor) {
  const TriangleSource source = soup.source();
  Trees trees;
  trees.build(executor, source, false);
  const bool closed = closedness_of(executor, source).suits(rule);
  std::vector<std::uint8_t> expected;
  for (const QueryPoint& p : points)
    expected.push_back(inside_by_brute_force(soup, p.at, rule) ? 1 : 0);
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    std::vector<std::uint8_t> inside(points.size());
    find_inside(executor, trees.scene(), PointList(points), rule, closed, inside);
    EXPECT_EQ(inside, expected);
    std::vector<double> distances(points.size());
    find_signed_distances(executor, trees.scene(), PointList(points), rule, closed, distances);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double distance = nearest_by_brute_force(soup, points[i], 1).front().distance;
      const double wanted = expected[i] != 0 && distance > 0 ? -distance : distance;
      EXPECT_TRUE(same_bits(distances[i], wanted)) << i << ": " << distances[i] << ", " << wanted;
    }
  });
  return static_cast<std::size_t>(std::count(expected.begin(), expected.end(), 1));
}

/// A box of twelve triangles that face outwards.
void add_box(Vec3 low, Vec3 high, Soup* soup) {
  const auto at = [&](int i) {
    return Vec3{(i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                (i & 4) != 0 ? high.z : low.z};
  };
  for (const auto& [a, b, c, d] : {std::array{0, 2, 3, 1},
                                   {4, 5, 7, 6},
                                   {0, 1, 5, 4},
                                   {2, 6, 7, 3},
                                   {0, 4, 6, 2},
                                   {1, 3, 7, 5}}) {
    soup->add(at(a), at(b), at(c));
    soup->add(at(a), at(c), at(d));
  }
}

TEST(Inside, AllShapes) {
  Random random(1);
  const Executor executor(2);
  for (const Shape shape : kShapes) {
    SCOPED_TRACE(static_cast<int>(shape));
    Soup soup = make_soup(shape, 150, random);
    const std::vector<QueryPoint> points = any_points(soup, 200, random);
    for (const InsideRule rule : {InsideRule::kNonZero, InsideRule::kEvenOdd})
      expect_right(soup, points, rule, executor);
  }
}

/// Rays agree wherever they come from and whatever they meet: edges, corners, faces along them.
TEST(Inside, RaysFromClosedSurfacesAgree) {
  Random random(2);
  Soup soup;
  for (int i = 0; i < 12; ++i) {
    const Vec3 low = lattice_point(random);
    const auto side = [&] { return 1.0f + static_cast<float>(random.below(4)); };
    add_box(low, low + Vec3{side(), side(), side()}, &soup);
  }
  add_closed(8, &soup);
  const Closedness closed = closedness_of(Executor(1), soup.source());
  EXPECT_TRUE(closed.winds && closed.is_even);
  const std::vector<QueryPoint> points = any_points(soup, 3000, random);
  std::size_t inside = 0;
  for (const QueryPoint& p : points) {
    const Sums first = sums_by_brute_force(soup, p.at, 0);
    inside += first.winding != 0 ? 1 : 0;
    for (int ray = 1; ray < kAxisRays; ++ray) {
      const Sums sums = sums_by_brute_force(soup, p.at, ray);
      EXPECT_EQ(sums.winding, first.winding);
      EXPECT_EQ(sums.number % 2, first.number % 2);
    }
  }
  EXPECT_GT(inside, 500u);
  EXPECT_LT(inside, 2500u);
  for (const InsideRule rule : {InsideRule::kNonZero, InsideRule::kEvenOdd})
    EXPECT_GT(expect_right(soup, {points.begin(), points.begin() + 500}, rule, Executor(1)), 50u);
}

/// If boxes fill space, each point is in one of them, including points on their walls.
TEST(Inside, BoxesThatFillSpaceShareNoPoint) {
  Random random(3);
  std::vector<Soup> boxes;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z) {
        const Vec3 low{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
        boxes.emplace_back();
        add_box(low, low + Vec3{1, 1, 1}, &boxes.back());
      }
  for (int i = 0; i < 2000; ++i) {
    const auto coordinate = [&] {
      const double half = 0.5 * random.below(6);
      return random.below(3) == 0 ? 2.9 * static_cast<double>(random.unit()) : half;
    };
    const Point p{coordinate(), coordinate(), coordinate()};
    int owners = 0;
    for (const Soup& box : boxes)
      owners += inside_by_brute_force(box, p, InsideRule::kNonZero) ? 1 : 0;
    EXPECT_EQ(owners, 1) << p.x << ' ' << p.y << ' ' << p.z;
  }
}

TEST(Inside, OverlapsCountOnceOrCancel) {
  Soup soup;
  add_box({0, 0, 0}, {2, 2, 2}, &soup);
  add_box({1, 1, 1}, {3, 3, 3}, &soup);
  const Point both{1.5, 1.5, 1.5}, one{0.5, 0.5, 0.5}, none{0.5, 2.5, 2.5};
  EXPECT_TRUE(inside_by_brute_force(soup, both, InsideRule::kNonZero));
  EXPECT_FALSE(inside_by_brute_force(soup, both, InsideRule::kEvenOdd));
  for (const InsideRule rule : {InsideRule::kNonZero, InsideRule::kEvenOdd}) {
    EXPECT_TRUE(inside_by_brute_force(soup, one, rule));
    EXPECT_FALSE(inside_by_brute_force(soup, none, rule));
  }
}

/// A box without a lid: most rays know.
TEST(Inside, OpenSurfaces) {
  Soup soup;
  add_box({-1, -1, -1}, {1, 1, 1}, &soup);
  soup.positions.resize(soup.positions.size() - 6);
  const Closedness closed = closedness_of(Executor(1), soup.source());
  EXPECT_FALSE(closed.winds || closed.is_even);
  Random random(4);
  std::vector<QueryPoint> points;
  for (int i = 0; i < 500; ++i) points.push_back({to_point(random.in_box(2)), {}});
  for (QueryPoint& p : points) p.radius = 100;
  for (const InsideRule rule : {InsideRule::kNonZero, InsideRule::kEvenOdd}) {
    std::size_t inside = 0;
    for (const QueryPoint& p : points)
      inside += std::max({std::fabs(p.at.x), std::fabs(p.at.y), std::fabs(p.at.z)}) < 1 ? 1 : 0;
    EXPECT_EQ(expect_right(soup, points, rule, Executor(1)), inside);
  }
}

TEST(Inside, KnowsClosedSurfaces) {
  Random random(5);
  const Executor executor(2);
  Soup soup;
  add_closed(60, &soup);
  const auto of = [&] { return closedness_of(executor, soup.source()); };
  EXPECT_TRUE(of().winds && of().is_even);
  for (Vec3& p : soup.positions) p = {-p.x, p.y, p.z};  // inside out; -0 is 0
  EXPECT_TRUE(of().winds && of().is_even);
  std::swap(soup.positions[3], soup.positions[4]);  // one triangle faces the other way
  EXPECT_TRUE(!of().winds && of().is_even);
  soup.add({1, 2, 3}, {4, 5, 6}, {4, 5, 6});  // without area
  EXPECT_TRUE(!of().winds && of().is_even);
  soup.positions[7].x = std::nextafter(soup.positions[7].x, 100.0f);
  EXPECT_FALSE(of().winds || of().is_even);
}

/// Determinants of 53 bits and fewer, which 113 bits hold: in a grid of 2^-20, and points of 2^-45.
TEST(Inside, PredicatesAreExact) {
  Random random(6);
  const auto sign = [](Wide x) { return x > 0 ? 1 : x < 0 ? -1 : 0; };
  int zeros = 0;
  for (int i = 0; i < 200'000; ++i) {
    const auto corner = [&] {
      const auto c = [&] {
        return 1 + 0.25f * static_cast<float>(random.below(5)) +
               0x1p-20f * static_cast<float>(random.below(3));
      };
      return to_point({c(), c(), c()});
    };
    const Point a = corner(), b = corner(), c = corner();
    Point p = a + 0.5 * ((b - a) + (c - a));
    if (random.below(2) == 0) p.x += 0x1p-45 * (1.0 - random.below(3));
    if (random.below(2) == 0) p.z += 0x1p-45 * (1.0 - random.below(3));
    const auto wide = [](Point q, Point r) {
      return std::array<Wide, 3>{Wide{q.x} - r.x, Wide{q.y} - r.y, Wide{q.z} - r.z};
    };
    const auto u = wide(b, a), v = wide(c, a), w = wide(p, a);
    const Wide plane = w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
                       w[2] * (u[0] * v[1] - u[1] * v[0]);
    EXPECT_EQ(side_of_plane(p, a, b, c), sign(plane));
    const auto to_b = wide(b, p), to_a = wide(a, p);
    EXPECT_EQ(side_of_line(p.x, p.y, a.x, a.y, b.x, b.y),
              sign(to_a[0] * to_b[1] - to_a[1] * to_b[0]));
    zeros += sign(plane) == 0 ? 1 : 0;
  }
  EXPECT_GT(zeros, 10'000);
  EXPECT_LT(zeros, 190'000);
}

/// Coordinates of any magnitude: moving a point of the plane by the least that a double can, along
/// the normal's axis, says on which side it is.
TEST(Inside, PredicatesAreExactAtAnyScale) {
  Random random(7);
  for (int i = 0; i < 100'000; ++i) {
    const float scale = std::ldexp(1.0f, static_cast<int>(random.below(180)) - 120);
    const auto c = [&] { return scale * (1 + static_cast<float>(random.below(16))); };
    const double height = c();  // the plane z = height, corners counter-clockwise from above
    const Point a{c(), c(), height}, b = a + Point{c(), 0, 0}, d = a + Point{0, c(), 0};
    const Point p{c(), c(), height};
    EXPECT_EQ(side_of_plane(p, a, b, d), 0);
    EXPECT_EQ(side_of_plane({p.x, p.y, std::nextafter(height, 1e30)}, a, b, d), 1);
    EXPECT_EQ(side_of_plane({p.x, p.y, std::nextafter(height, 0)}, a, b, d), -1);
    EXPECT_EQ(side_of_plane(p, b, a, d), 0);
    EXPECT_EQ(side_of_plane({p.x, p.y, std::nextafter(height, 0)}, b, a, d), 1);
  }
}

}  // namespace
}  // namespace raysheaf::test
