// Points in two levels have the answers of the flat scene, bit for bit, and the bound by which they
// enter instances holds.
#include <cmath>

#include "levels/instances.h"
#include "nearest/nearest_support.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

constexpr Kind kSimilarKinds[] = {Kind::kMoved, Kind::kTurned, Kind::kQuarter, Kind::kSimilar,
                                  Kind::kMirrored};

Affine scaled(const Affine& map, float by) {
  return compose(map, scaling({by, by, by}));
}

/// However near the image of a point of the mesh is, the point is as near in the mesh, with the
/// allowance for what is rounded.
TEST(PlacingOfPoints, BoundsDistances) {
  Random random(1);
  double worst = 0;
  for (int n = 0; n < 20000; ++n) {
    const float reach = random.below(2) == 0 ? 10.0f : 1e5f;
    const float scale = std::exp(random.between(-14, 14));
    const Affine map = scaled(random_map(kSimilarKinds[random.below(5)], reach, random), scale);
    const Vec3 far = random.in_box(random.below(2) == 0 ? 1.0f : 300.0f);
    const Vec3 p = far + random.in_box(1);
    const Placing placing = make_placing(map, {far - Vec3{1, 1, 1}, far + Vec3{1, 1, 1}});
    ASSERT_GT(placing.stretch, 0);
    const Point image = to_point(transform_point(map, p));
    const double away = random.below(3) == 0 ? 0 : std::exp(random.between(-20, 10)) * scale;
    const Point q = image + away * to_point(random.direction());
    const Point from = q - Point{map.m[0][3], map.m[1][3], map.m[2][3]};
    long double squared = 0, in_world = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const long double gap =
          static_cast<long double>(placing.to_mesh(axis, from.x, from.y, from.z)) -
          component(p, axis);
      const long double step =
          static_cast<long double>(component(q, axis)) - component(image, axis);
      squared += gap * gap;
      in_world += step * step;
    }
    const double gap = placing.gap_of(std::sqrt(dot(q, q)));
    const long double need =
        std::sqrt(squared) * static_cast<long double>(placing.stretch) - std::sqrt(in_world);
    EXPECT_LE(need, gap);
    worst = std::max(worst, static_cast<double>(need) / gap);
  }
  EXPECT_GT(worst, 0.1);  // it is needed, and not much larger than need be
}

TEST(PlacingOfPoints, BoundsNoDistancesUnderOtherMaps) {
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  for (const Vec3 by : {Vec3{1, 1, 0}, {0, 0, 0}, {1, 1.01f, 1}, {1e-30f, 1e-30f, 1e-30f}})
    EXPECT_EQ(make_placing(scaling(by), box).stretch, 0);
  EXPECT_TRUE(make_placing(scaling({1e6f, 0, 1e6f}), box).has_boxes);
  EXPECT_FALSE(make_placing(scaling({1e36f, 1, 1}), box).has_boxes);
}

/// Also maps without an inverse.
Affine any_map(float reach, Random& random) {
  Affine map = random_map(kKinds[random.below(9)], reach, random);
  switch (random.below(12)) {
    case 0:
      return compose(map, scaling({1, 0, 1}));
    case 1:
      return compose(map, scaling({0, 0, 0.5f}));
    default:
      return map;
  }
}

/// Which instances a point sees.
struct Sight {
  std::uint32_t mask = 0xffffffff;
  WorldId world = kAllWorlds;

  [[nodiscard]] bool sees(const Instances& instances, std::size_t i) const {
    const ItemWorlds worlds{&world};
    return (instances.instances()[i].mask & mask) != 0 && worlds.meet(0, instances.world_of(i));
  }
};

/// The nearest triangles of the instances that are seen.
std::vector<FoundTriangle> nearest_of(const Instances& instances, const QueryPoint& point,
                                      std::size_t k, const Sight& sight = {}) {
  std::vector<FoundTriangle> all;
  std::size_t instance = 0;
  for (std::uint32_t i = 0; i < instances.world.count(); ++i) {
    while (instance + 1 < instances.instances().size() && instances.first_of(instance + 1) <= i)
      ++instance;
    const double distance = distance_of(point.at, instances.world, i);
    if (distance <= point.radius && sight.sees(instances, instance))
      all.push_back({distance, std::uint64_t{instance} << 32 | (i - instances.first_of(instance))});
  }
  std::sort(all.begin(), all.end(), is_nearer);
  all.resize(k);
  return all;
}

bool inside_of(const Instances& instances, Point p, InsideRule rule, const Sight& sight) {
  Soup seen;
  for (std::size_t i = 0; i < instances.instances().size(); ++i) {
    if (!sight.sees(instances, i)) continue;
    const std::uint32_t end =
        i + 1 < instances.instances().size() ? instances.first_of(i + 1) : instances.world.count();
    for (std::uint32_t t = instances.first_of(i); t < end; ++t) {
      const auto [a, b, c] = instances.world.corners(t);
      seen.add(a, b, c);
    }
  }
  return inside_by_brute_force(seen, p, rule);
}

/// Points near the surface ask for what is exactly as far away as something is.
std::vector<QueryPoint> points_at_limits(const Instances& instances, std::size_t count,
                                         Random& random, float scale) {
  std::vector<QueryPoint> points;
  while (points.size() < count) {
    QueryPoint point = any_point(instances.world, random);
    const Vec3 on = instances.world.corners(random.below(instances.world.count()))[0];
    if (random.below(2) == 0)
      point.at = to_point(on) +
                 (double{scale} * std::exp(random.between(-25, 1))) * to_point(random.direction());
    point.radius = std::numeric_limits<double>::infinity();
    const auto near = nearest_of(instances, point, 1 + random.below(3));
    if (near.back().triangle != kNoTriangle) point.radius = near.back().distance;
    points.push_back(point);
  }
  return points;
}

/// The worlds of points, or none where all are in all.
using Worlds = std::vector<WorldId>;

Sight sight_of(std::size_t point, const Worlds& worlds, std::uint32_t mask) {
  return {mask, worlds.empty() ? kAllWorlds : worlds[point]};
}

void expect_nearest(Instances& instances, const std::vector<QueryPoint>& points,
                    std::uint32_t mask = 0xffffffff, bool refit = false,
                    const Worlds& worlds = {}) {
  const LevelScene levels = instances.scene(refit);
  const NearestScene scene{.levels = &levels, .worlds = {worlds.data()}, .mask = mask};
  for (const std::uint32_t k : {1u, 2u, 9u}) {
    std::vector<FoundTriangle> expected;
    for (std::size_t i = 0; i < points.size(); ++i)
      for (const FoundTriangle& one :
           nearest_of(instances, points[i], k, sight_of(i, worlds, mask)))
        expected.push_back(one);
    for_each_simd_target([&](const char* target) {
      std::vector<FoundTriangle> found(points.size() * k);
      find_nearest(instances.executor(), scene, PointList(points), k, [&](const NearestTile& tile) {
        std::copy(tile.found.begin(), tile.found.end(),
                  found.begin() + static_cast<std::ptrdiff_t>(tile.begin * k));
      });
      std::size_t differ = 0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        bool same = test::same_bits(found[i].distance, expected[i].distance) &&
                    found[i].triangle == expected[i].triangle;
        if (same && found[i].triangle != kNoTriangle) {
          const std::uint32_t number =
              instances.first_of(found[i].tree) + static_cast<std::uint32_t>(found[i].triangle);
          const Corners c = scene.corners(found[i]);
          const auto [x, y, z] = instances.world.corners(number);
          same = c.a == x && c.b == y && c.c == z;
        }
        differ += same ? 0 : 1;
      }
      EXPECT_EQ(differ, 0u) << "of " << found.size() << ", " << target << ", k " << k;
    });
  }
}

/// Returns how many are inside.
std::size_t expect_inside(Instances& instances, const std::vector<QueryPoint>& points,
                          std::uint32_t mask = 0xffffffff, const Worlds& worlds = {}) {
  const LevelScene levels = instances.scene();
  std::vector<Closedness> meshes;
  for (std::size_t i = 0; i < instances.instances().size(); ++i)
    meshes.push_back(closedness_of(Executor(1), instances.mesh_of(i)));
  const NearestScene scene{
      .levels = &levels, .worlds = {worlds.data()}, .mask = mask, .meshes = meshes};
  std::vector<double> nearest;
  for (std::size_t i = 0; i < points.size(); ++i)
    nearest.push_back(
        nearest_of(instances, points[i], 1, sight_of(i, worlds, mask)).front().distance);
  std::size_t inside = 0;
  for (const InsideRule rule : {InsideRule::kNonZero, InsideRule::kEvenOdd}) {
    bool closed = true;
    for (std::size_t i = 0; i < meshes.size(); ++i)
      closed = closed && ((instances.instances()[i].mask & mask) == 0 || meshes[i].suits(rule));
    std::vector<std::uint8_t> expected;
    for (std::size_t i = 0; i < points.size(); ++i)
      expected.push_back(inside_of(instances, points[i].at, rule, sight_of(i, worlds, mask)) ? 1
                                                                                             : 0);
    inside += static_cast<std::size_t>(std::count(expected.begin(), expected.end(), 1));
    for_each_simd_target([&](const char* target) {
      SCOPED_TRACE(target);
      std::vector<std::uint8_t> found(points.size());
      find_inside(instances.executor(), scene, PointList(points), rule, closed, found);
      EXPECT_EQ(found, expected);
      std::vector<double> distances(points.size());
      find_signed_distances(instances.executor(), scene, PointList(points), rule, closed,
                            distances);
      std::size_t differ = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double wanted = expected[i] != 0 && nearest[i] > 0 ? -nearest[i] : nearest[i];
        differ += test::same_bits(distances[i], wanted) ? 0 : 1;
      }
      EXPECT_EQ(differ, 0u) << "of " << points.size();
    });
  }
  return inside;
}

TEST(LevelPoints, HaveTheNearestOfTheFlatScene) {
  Random random(2);
  for (const Shape shape : kShapes) {
    for (const float reach : {0.0f, 20.0f, 1e5f}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(shape) << " " << reach);
      Instances instances;
      instances.for_points = true;
      instances.add_mesh(make_soup(shape, 40, random));
      instances.add_mesh(make_soup(Shape::kClosed, 40, random, 1, random.in_box(reach)));
      for (int i = 0; i < 12; ++i) instances.place(random.below(2), any_map(reach, random));
      expect_nearest(instances, any_points(instances.world, 100, random, 1 + 0.1f * reach));
      expect_nearest(instances, points_at_limits(instances, 50, random, 1));
      expect_nearest(instances, any_points(instances.world, 50, random, 2), 1 + random.below(6));
    }
  }
}

TEST(LevelPoints, SmallAndLargeAndFarFromTheirOrigin) {
  Random random(3);
  for (const float scale : {1e-6f, 1e-3f, 1e3f, 1e6f}) {
    for (const float offset : {0.0f, 300.0f, 1e5f}) {
      SCOPED_TRACE(testing::Message() << scale << " " << offset);
      Instances instances;
      instances.for_points = true;
      instances.add_mesh(make_soup(Shape::kSmall, 100, random, 1, {offset, offset, -offset}));
      for (int i = 0; i < 10; ++i)
        instances.place(0, scaled(random_map(kKinds[random.below(9)], 10 * scale, random), scale));
      expect_nearest(instances, any_points(instances.world, 150, random, scale));
      expect_nearest(instances, points_at_limits(instances, 100, random, scale));
    }
  }
}

TEST(LevelPoints, FollowTheirInstances) {
  Random random(4);
  for (const std::uint32_t count : {1u, 40u, 200u}) {
    Instances instances;
    instances.add_mesh(make_soup(Shape::kSmall, 30, random));
    for (std::uint32_t i = 0; i < count; ++i)
      instances.place(0, random_map(Kind::kTurned, 50, random));
    static_cast<void>(instances.scene());
    instances.move_all([&] { return random_map(kKinds[1 + random.below(7)], 50, random); });
    expect_nearest(instances, any_points(instances.world, 100, random, 3), 0xffffffff, true);
  }
}

/// Closed and open meshes, that overlap, are mirrored, and lie flat.
TEST(LevelPoints, AreInsideWhereTheyAreInTheFlatScene) {
  Random random(5);
  std::size_t inside = 0;
  for (const bool has_open : {false, true}) {
    for (const float reach : {3.0f, 30.0f}) {
      for (int n = 0; n < 4; ++n) {
        Instances instances;
        instances.for_points = true;
        instances.add_mesh(make_soup(Shape::kClosed, 60, random));
        instances.add_mesh(make_soup(Shape::kClosed, 100, random, 0.5f, random.in_box(2)));
        if (has_open) instances.add_mesh(make_soup(kShapes[random.below(9)], 30, random));
        for (int i = 0; i < 9; ++i)
          instances.place(random.below(has_open ? 3 : 2), any_map(reach, random));
        const std::vector<QueryPoint> points = any_points(instances.world, 120, random);
        inside += expect_inside(instances, points);
        expect_inside(instances, points, 1 + random.below(6));
      }
    }
  }
  EXPECT_GT(inside, 300u);
}

/// Worlds that stand in the same place: of none, few and many instances, and one in all worlds.
TEST(LevelPoints, SeeTheirWorlds) {
  Random random(6);
  const auto any_world = [&] { return random.below(9) == 0 ? kAllWorlds : random.below(5); };
  std::size_t inside = 0;
  for (const std::uint32_t count : {1u, 12u, 90u}) {
    for (const float reach : {3.0f, 1e4f}) {
      SCOPED_TRACE(testing::Message() << count << " " << reach);
      Instances instances;
      instances.for_points = true;
      instances.add_mesh(make_soup(Shape::kClosed, 40, random));
      instances.add_mesh(make_soup(Shape::kSmall, 20, random));
      for (std::uint32_t i = 0; i < count; ++i)
        instances.place(random.below(2), any_map(reach, random),
                        i % 8 == 7 ? any_world() : random.below(2));
      for (const bool grouped : {false, true}) {
        std::vector<QueryPoint> points = any_points(instances.world, 150, random, 1 + 0.1f * reach);
        for (const QueryPoint& point : points_at_limits(instances, 50, random, 1))
          points.push_back(point);
        Worlds worlds(points.size());
        std::generate(worlds.begin(), worlds.end(), any_world);
        if (grouped) std::sort(worlds.begin(), worlds.end());
        expect_nearest(instances, points, 1 + random.below(7), false, worlds);
        inside += expect_inside(instances, points, 0xffffffff, worlds);
      }
    }
  }
  EXPECT_GT(inside, 100u);
}

}  // namespace
}  // namespace raysheaf::test
