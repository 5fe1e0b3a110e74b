// Instances that move while few rays and points follow: the answers are those of brute force, rays
// and points enter the instances where they stand, and many rays have them placed.
#include <array>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "base/vec.h"
#include "raysheaf/hit_points.h"
#include "raysheaf/points.h"
#include "raysheaf/query.h"
#include "support/random.h"

namespace raysheaf {
namespace {

using test::Random;

constexpr float kFar = std::numeric_limits<float>::infinity();

/// A bumpy sphere of about 1 around the origin, closed, 2 * side * (side - 1) triangles.
struct Ball {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;

  explicit Ball(std::uint32_t side, Random& random) {
    for (std::uint32_t i = 0; i <= side; ++i)
      for (std::uint32_t k = 0; k < side; ++k) {
        const float a = 3.1415927f * static_cast<float>(i) / static_cast<float>(side);
        const float b = 6.2831853f * static_cast<float>(k) / static_cast<float>(side);
        const float r = random.between(0.8f, 1.2f);
        positions.push_back(
            {r * std::sin(a) * std::cos(b), r * std::cos(a), r * std::sin(a) * std::sin(b)});
      }
    // A pole is one vertex.
    const auto at = [side](std::uint32_t i, std::uint32_t k) {
      return i == 0 || i == side ? i * side : i * side + k % side;
    };
    for (std::uint32_t i = 0; i < side; ++i)
      for (std::uint32_t k = 0; k < side; ++k) {
        if (i > 0) triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k)});
        if (i + 1 < side) triangles.push_back({at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
      }
  }
};

Affine any_map(Random& random) {
  Affine map = rotation(random.direction(), random.between(-3, 3));
  if (random.below(4) == 0) map = compose(map, scaling({1, -0.5f, 2}));
  if (random.below(9) == 0) map = Affine();
  if (random.below(400) == 0) map = scaling({1, 0, 1});  // flat: rays cannot enter it
  const Vec3 to = random.in_box(9);
  map.m[0][3] = to.x, map.m[1][3] = to.y, map.m[2][3] = to.z;
  return map;
}

std::vector<Ray> any_rays(std::size_t count, Random& random) {
  std::vector<Ray> rays;
  while (rays.size() < count)
    rays.push_back({random.in_box(12), 0, random.direction(), random.below(4) == 0 ? 5.0f : kFar});
  return rays;
}

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

/// Returns whether rays have entered instances.
bool expect_right(const Scene& scene, const std::vector<Ray>& rays, QueryOptions options) {
  QueryStatistics statistics;
  options.statistics = &statistics;
  const std::vector<Hit> hits = closest_hit(scene, rays, options);
  const bool entered = !statistics.plan.empty() && statistics.plan[0].starts_with("instances: ent");
  const auto occluded = any_hit(scene, rays, options);
  const auto counts = hit_counts(scene, rays, options);
  const std::vector<HitPoint> points = hit_points(scene, rays, hits);
  options.method = QueryMethod::kBrute;
  EXPECT_TRUE(same(hits, closest_hit(scene, rays, options)));
  EXPECT_TRUE(same(occluded, any_hit(scene, rays, options)));
  EXPECT_TRUE(same(counts, hit_counts(scene, rays, options)));
  // Brute force has placed the instances.
  const std::vector<HitPoint> placed = hit_points(scene, rays, hits);
  for (std::size_t i = 0; i < rays.size(); ++i)
    EXPECT_EQ(std::memcmp(&points[i].position, &placed[i].position, sizeof(Vec3)), 0);
  return entered;
}

/// Returns whether points have entered instances.
bool expect_right(const Scene& scene, const std::vector<std::array<double, 3>>& points,
                  const std::vector<double>& radii, PointOptions options) {
  QueryStatistics statistics;
  options.statistics = &statistics;
  PointParts parts(points);
  if (!radii.empty()) parts.radii = NumberRows(radii.data(), 1);
  const auto closest = closest_point(scene, parts, options);
  const bool entered = !statistics.plan.empty() && statistics.plan[0].starts_with("instances: ent");
  const auto near = nearest(scene, parts, 5, options);
  const auto distances = signed_distance(scene, parts, options);
  const auto inside = contains(scene, parts, options);
  options.method = QueryMethod::kBrute;
  EXPECT_TRUE(same(closest, closest_point(scene, parts, options)));
  EXPECT_TRUE(same(near, nearest(scene, parts, 5, options)));
  EXPECT_TRUE(same(distances, signed_distance(scene, parts, options)));
  EXPECT_TRUE(same(inside, contains(scene, parts, options)));
  return entered;
}

/// Two meshes and their instances, which change.
struct MovingScene {
  Scene scene = Scene(Context({.threads = 2}));
  Ball ball, other;
  MeshId mesh = 0;
  std::vector<InstanceId> instances;

  /// `open`: one of the meshes has a hole.
  MovingScene(std::uint32_t side, bool open, Random& random)
      : ball(side, random), other(side - 4, random) {
    if (open) other.triangles.pop_back();
    mesh = scene.add(ball.positions, ball.triangles, {.place = false});
    instances = scene.instances(scene.add(other.positions, other.triangles));
    for (int i = 0; i < 30; ++i)
      instances.push_back(scene.instance(mesh, any_map(random), 1u << random.below(3)));
  }
  void step(Random& random) {
    std::vector<Affine> maps;
    for (std::size_t i = 0; i < instances.size(); ++i) maps.push_back(any_map(random));
    switch (random.below(6)) {
      case 0:
        scene.set_transform(instances[random.below(8)], any_map(random));
        break;
      case 1: {
        std::vector<Vec3> moved = ball.positions;
        for (Vec3& p : moved) p = p * random.between(0.9f, 1.1f);
        scene.update(mesh, moved);
        break;
      }
      case 2:
        scene.set_mask(instances.back(), 1u << random.below(3));
        [[fallthrough]];
      default:
        scene.set_transforms(instances, maps);
    }
    if (random.below(9) == 0) {
      scene.remove_instance(instances.back());
      instances.back() = scene.instance(mesh, any_map(random));
    }
    scene.commit();
  }
};

TEST(Levels, FollowMovingInstances) {
  Random random(1);
  MovingScene moving(36, true, random);
  int entered = 0;
  for (int frame = 0; frame < 25; ++frame) {
    SCOPED_TRACE(frame);
    moving.step(random);
    const std::vector<Ray> rays = any_rays(1 + random.below(20), random);
    std::vector<std::uint32_t> masks(rays.size());
    for (std::uint32_t& mask : masks) mask = random.bits();
    std::vector<TriangleId> skip(rays.size(), {moving.instances[2], 7});
    QueryOptions options;
    options.mask = random.below(2) == 0 ? 0xffffffff : 1u + random.below(7);
    if (random.below(2) == 0) options.sides = random.below(2) == 0 ? Sides::kFront : Sides::kBack;
    if (random.below(3) == 0) options.ray_masks = masks;
    if (random.below(3) == 0) options.skip = skip;
    entered += expect_right(moving.scene, rays, options) ? 1 : 0;
  }
  EXPECT_GT(entered, 8);
}

TEST(Levels, PointsEnterMovingInstances) {
  Random random(3);
  for (const bool open : {false, true}) {
    MovingScene moving(16, open, random);
    int entered = 0;
    for (int frame = 0; frame < 12; ++frame) {
      SCOPED_TRACE(testing::Message() << open << " " << frame);
      moving.step(random);
      std::vector<std::array<double, 3>> points(1 + random.below(30));
      std::vector<double> radii;
      for (auto& point : points) {
        const Vec3 p = random.in_box(10);
        point = {p.x + 1e-9, p.y, p.z};
        radii.push_back(random.between(0, 4));
      }
      if (random.below(2) == 0) radii.clear();
      PointOptions options;
      options.mask = random.below(2) == 0 ? 0xffffffff : 1u + random.below(7);
      options.inside = random.below(2) == 0 ? InsideRule::kNonZero : InsideRule::kEvenOdd;
      entered += expect_right(moving.scene, points, radii, options) ? 1 : 0;
    }
    EXPECT_GT(entered, 4);
  }
}

TEST(Levels, ManyRaysHaveInstancesPlaced) {
  Random random(2);
  Scene scene(Context({.threads = 2}));
  const Ball ball(20, random);
  const MeshId mesh = scene.add(ball.positions, ball.triangles, {.place = false});
  for (int i = 0; i < 20; ++i) static_cast<void>(scene.instance(mesh, any_map(random)));
  scene.commit();
  const auto plan_of = [&](std::size_t rays) {
    QueryStatistics statistics;
    QueryOptions options;
    options.statistics = &statistics;
    static_cast<void>(any_hit(scene, any_rays(rays, random), options));
    return statistics.plan[0];
  };
  EXPECT_TRUE(plan_of(10).starts_with("instances: entered")) << plan_of(10);
  EXPECT_FALSE(plan_of(100000).starts_with("instances: entered"));
  EXPECT_FALSE(plan_of(10).starts_with("instances: entered"));  // they are placed now
}

TEST(Levels, SetTransformsIsAllOrNothing) {
  Scene scene;
  const std::vector<Vec3> corners{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const MeshId mesh = scene.add_soup(corners);
  const InstanceId first = scene.instances(mesh)[0], second = scene.instance(mesh, Affine());
  scene.commit();
  const std::vector<Affine> maps{translation({0, 0, 1}), translation({0, 0, 2})};
  const auto refused = [&](std::vector<InstanceId> ids, std::vector<Affine> all, ErrorCode code) {
    try {
      scene.set_transforms(ids, all);
    } catch (const Error& error) {
      return error.code() == code && scene.is_committed();
    }
    return false;
  };
  EXPECT_TRUE(refused({first, 9}, maps, ErrorCode::kNotFound));
  EXPECT_TRUE(refused({first}, maps, ErrorCode::kInvalidArgument));
  EXPECT_TRUE(
      refused({first, second}, {maps[0], scaling({NAN, 1, 1})}, ErrorCode::kInvalidArgument));
  scene.set_transforms({}, {});
  EXPECT_TRUE(scene.is_committed());
  const std::vector<InstanceId> both{first, second};
  scene.set_transforms(both, maps);
  scene.commit();
  const Ray ray{{0.2f, 0.2f, 0}, 0, {0, 0, 1}, kFar};
  EXPECT_EQ(closest_hit(scene, std::span(&ray, 1))[0].t, 2);
}

}  // namespace
}  // namespace raysheaf
