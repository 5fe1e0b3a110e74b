// Many worlds in one scene: a ray or a point gets the answers of a scene of its own world, which
// has only the instances that it sees.
#include <cstring>
#include <map>

#include "api/api_support.h"
#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "raysheaf/points.h"
#include "support/guarded_memory.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

constexpr QueryMethod kAskedBy[] = {QueryMethod::kDual, QueryMethod::kBrute};

WorldId any_world(Random& random) {
  constexpr WorldId kWorlds[] = {0, 1, 2, 3, 40, 0xfffffffe, kAllWorlds};
  return kWorlds[random.below(std::size(kWorlds))];
}

Affine any_place(Random& random) {
  Affine map = rotation(random.direction(), random.between(-3, 3));
  if (random.below(4) == 0) map = compose(map, scaling({1, -0.5f, 2}));
  const Vec3 to = random.in_box(4);
  map.m[0][3] = to.x, map.m[1][3] = to.y, map.m[2][3] = to.z;
  return map;
}

/// A box, which is closed, a half of one, a soup, and a ground that all worlds share.
void fill_worlds(Scene* scene, std::size_t instances, Random& random) {
  const Cube cube;
  const MeshId box = scene->add(cube.positions, cube.triangles, {.place = false});
  const MeshId half =
      scene->add(cube.positions, std::span(cube.triangles).first(6), {.place = false});
  const MeshId soup = scene->add_soup(RandomSoup(20, 0).positions, {.place = false});
  const Square ground(-4, 9);
  scene->add(ground.positions, ground.triangles);
  for (const MeshId mesh : {box, half, soup}) {
    std::vector<Affine> maps;
    std::vector<WorldId> worlds;
    for (std::size_t i = 0; i < instances; ++i) {
      maps.push_back(any_place(random));
      worlds.push_back(any_world(random));
    }
    const InstanceId first = scene->instances(mesh, maps, worlds, 1u << random.below(3));
    for (std::uint32_t i = 0; i < instances; ++i) EXPECT_EQ(scene->world(first + i), worlds[i]);
  }
  scene->commit();
}

/// A copy with the instances that an item of this world sees, and with the same ids.
Scene seen_from(const Scene& scene, WorldId world) {
  Scene seen = scene.copy();
  for (const MeshId mesh : scene.meshes())
    for (const InstanceId instance : scene.instances(mesh)) {
      const WorldId own = scene.world(instance);
      if (own != world && own != kAllWorlds && world != kAllWorlds) seen.remove_instance(instance);
    }
  seen.commit();
  return seen;
}

std::vector<Ray> any_rays(std::size_t count, Random& random) {
  std::vector<Ray> rays;
  while (rays.size() < count)
    rays.push_back({random.in_box(6), 0, random.direction(), random.below(4) == 0 ? 5 : kInfinity});
  return rays;
}

template <class T>
bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// Which of the items are in each world.
std::map<WorldId, std::vector<std::size_t>> by_world(std::span<const WorldId> worlds) {
  std::map<WorldId, std::vector<std::size_t>> items;
  for (std::size_t i = 0; i < worlds.size(); ++i) items[worlds[i]].push_back(i);
  return items;
}

void expect_rays(const Scene& scene, const std::vector<Ray>& rays, std::span<const WorldId> worlds,
                 const QueryOptions& options) {
  const std::vector<Hit> hits = closest_hit(scene, rays, options);
  const std::vector<std::uint8_t> occluded = any_hit(scene, rays, options);
  const std::vector<std::uint32_t> counts = hit_counts(scene, rays, options);
  const HitRows all = all_hits(scene, rays, options), first = first_hits(scene, rays, 2, options);
  for (const auto& [world, items] : by_world(worlds)) {
    const Scene seen = seen_from(scene, world);
    std::vector<Ray> own;
    for (const std::size_t i : items) own.push_back(rays[i]);
    QueryOptions alone;
    alone.method = QueryMethod::kBrute;
    alone.mask = options.mask;
    alone.sides = options.sides;
    const HitRows rows = all_hits(seen, own, alone);
    for (std::size_t k = 0; k < items.size(); ++k) {
      const std::size_t i = items[k];
      const Hit nearest = rows[k].empty() ? Hit{} : rows[k].front();
      ASSERT_TRUE(same(hits[i], nearest))
          << world << ": " << shown(hits[i]) << ", not " << shown(nearest);
      ASSERT_EQ(occluded[i], rows[k].empty() ? 0 : 1);
      ASSERT_EQ(counts[i], rows[k].size());
      ASSERT_TRUE(std::ranges::equal(all[i], rows[k], same));
      ASSERT_EQ(first[i].size(), std::min<std::size_t>(2, rows[k].size()));
      ASSERT_TRUE(std::ranges::equal(first[i], rows[k].first(first[i].size()), same));
    }
  }
}

void expect_points(const Scene& scene, const std::vector<Vec3>& points,
                   std::span<const WorldId> worlds, const PointOptions& options) {
  const auto found = nearest(scene, points, 3, options);
  const auto closest = closest_point(scene, points, options);
  const auto distances = signed_distance(scene, points, options);
  const auto inside = contains(scene, points, options);
  for (const auto& [world, items] : by_world(worlds)) {
    const Scene seen = seen_from(scene, world);
    std::vector<Vec3> own;
    for (const std::size_t i : items) own.push_back(points[i]);
    PointOptions alone;
    alone.method = QueryMethod::kBrute;
    alone.mask = options.mask;
    alone.inside = options.inside;
    const auto right = nearest(seen, own, 3, alone);
    const auto right_distances = signed_distance(seen, own, alone);
    const auto right_inside = contains(seen, own, alone);
    for (std::size_t k = 0; k < items.size(); ++k) {
      const std::size_t i = items[k];
      for (std::size_t n = 0; n < 3; ++n)
        ASSERT_TRUE(same_bits(found[3 * i + n], right[3 * k + n])) << world << ": " << n;
      ASSERT_TRUE(same_bits(closest[i], right[3 * k])) << world;
      ASSERT_TRUE(same_bits(distances[i], right_distances[k])) << world;
      ASSERT_EQ(inside[i], right_inside[k]) << world;
    }
  }
}

/// Queries of all kinds, of rays and points in any worlds.
void expect_right(const Scene& scene, std::size_t count, Random& random) {
  const std::vector<Ray> rays = any_rays(count, random);
  std::vector<Vec3> points;
  std::vector<WorldId> worlds;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(random.in_box(5));
    worlds.push_back(random.below(9) == 0 ? 77 : any_world(random));  // no instance is in 77
  }
  if (random.below(2) == 0) std::ranges::sort(worlds);
  for (const QueryMethod method : kAskedBy) {
    QueryOptions options;
    options.method = method;
    options.ray_worlds = worlds;
    if (random.below(2) == 0) options.sides = Sides::kFront;
    if (random.below(2) == 0) options.mask = 1 + random.below(7);
    expect_rays(scene, rays, worlds, options);
    PointOptions of_points;
    of_points.method = method;
    of_points.point_worlds = worlds;
    of_points.mask = options.mask;
    if (random.below(2) == 0) of_points.inside = InsideRule::kEvenOdd;
    expect_points(scene, points, worlds, of_points);
  }
}

TEST(Worlds, AreScenesOfTheirOwn) {
  Random random(1);
  for (const std::size_t instances : {0, 1, 9, 60, 300}) {  // 300: over 64 in a world
    Scene scene(Context({.threads = 2}));
    fill_worlds(&scene, instances, random);
    expect_right(scene, 200, random);
  }
}

TEST(Worlds, OnEverySimdTarget) {
  Random random(2);
  Scene scene;
  fill_worlds(&scene, 20, random);
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    expect_right(scene, 100, random);
  });
}

TEST(Worlds, FollowChanges) {
  Random random(3);
  Scene scene(Context({.threads = 2}));
  fill_worlds(&scene, 12, random);
  for (int step = 0; step < 12; ++step) {
    SCOPED_TRACE(step);
    const std::vector<InstanceId> ids = instances_of(scene);
    const InstanceId one = ids[random.below(static_cast<std::uint32_t>(ids.size()))];
    switch (random.below(5)) {
      case 0:
        scene.set_world(one, any_world(random));
        break;
      case 1:
        scene.remove_instance(one);
        break;
      case 2:
        scene.instance(random.below(3), any_place(random), 0xffffffff, any_world(random));
        break;
      case 3:
        scene.set_transform(one, any_place(random));
        break;
      default: {
        std::vector<Affine> maps;
        for (std::size_t i = 0; i < ids.size(); ++i) maps.push_back(any_place(random));
        if (random.below(6) == 0) maps[0] = scaling({1, 0, 1});  // flat: rays cannot enter it
        scene.set_transforms(ids, maps);
      }
    }
    scene.commit();
    expect_right(scene, 60, random);
  }
}

TEST(Worlds, HaveEqualNumbersOfItems) {
  Random random(4);
  Scene scene;
  fill_worlds(&scene, 20, random);
  const std::vector<Ray> rays = any_rays(42, random);
  std::vector<Vec3> points;
  std::vector<WorldId> worlds;
  for (std::uint32_t i = 0; i < 42; ++i) {
    points.push_back(random.in_box(5));
    worlds.push_back(i / 6);
  }
  for (const QueryMethod method : kAskedBy) {
    expect_rays(scene, rays, worlds, {.method = method, .rays_per_world = 6});
    expect_points(scene, points, worlds, {.method = method, .points_per_world = 6});
  }
  QueryStatistics statistics;
  PointOptions options;
  options.points_per_world = 6;
  options.statistics = &statistics;
  static_cast<void>(closest_point(scene, points, options));
  EXPECT_NE(statistics.plan[0].find("points in one world"), std::string::npos);
}

TEST(Worlds, OnDevicesByTheCpu) {
  const Executor executor(2);
  GuardedMemory memory;
  const Context context =
      ContextAccess::with_backend({.device = Device::kCuda}, open_emulated(executor, memory));
  Random random(5);
  Scene scene(context);
  fill_worlds(&scene, 9, random);
  expect_right(scene, 60, random);
}

TEST(Worlds, AreSeenByWhoIsInNone) {
  Scene scene;
  const Square near(1), far(2);
  scene.add(near.positions, near.triangles, {.world = 5});
  scene.add(far.positions, far.triangles);
  scene.commit();
  const Ray ray = along_z();
  EXPECT_EQ(first_hit(scene, ray).t, 11);
  const std::vector<Ray> rays(4, ray);
  const std::vector<WorldId> worlds{4, 5, kAllWorlds, 0};
  const std::vector<Hit> hits = closest_hit(scene, rays, {.ray_worlds = worlds});
  EXPECT_EQ(hits[0].t, 12);
  EXPECT_EQ(hits[1].t, 11);
  EXPECT_EQ(hits[2].t, 11);
  EXPECT_EQ(hits[3].t, 12);
}

TEST(Worlds, RefuseWhatDoesNotFit) {
  Random random(6);
  Scene scene;
  fill_worlds(&scene, 2, random);
  const std::vector<Ray> rays = any_rays(6, random);
  const std::vector<Vec3> points(6);
  const std::vector<WorldId> worlds(6), few(5);
  const auto refuse = [&](const char* place, const char* words, const QueryOptions& options) {
    expect_error(ErrorCode::kInvalidArgument, place, words,
                 [&] { static_cast<void>(closest_hit(scene, rays, options)); });
  };
  refuse("ray_worlds", "5 are given for 6 rays", {.ray_worlds = few});
  refuse("rays_per_world", "6 rays are not a multiple of 4", {.rays_per_world = 4});
  refuse("rays_per_world", "besides ray_worlds", {.ray_worlds = worlds, .rays_per_world = 3});
  const auto refuse_points = [&](const char* place, const char* words,
                                 const PointOptions& options) {
    expect_error(ErrorCode::kInvalidArgument, place, words,
                 [&] { static_cast<void>(closest_point(scene, points, options)); });
  };
  refuse_points("point_worlds", "5 are given for 6 points", {.point_worlds = few});
  refuse_points("points_per_world", "6 points are not a multiple of 4", {.points_per_world = 4});
  refuse_points("points_per_world", "besides point_worlds",
                {.point_worlds = worlds, .points_per_world = 3});
}

TEST(Worlds, InstancesAreMadeAllOrNone) {
  Scene scene;
  const Square square;
  const MeshId mesh = scene.add(square.positions, square.triangles);
  scene.commit();
  const std::vector<Affine> maps{translation({0, 0, 1}), scaling({kNaN, 1, 1})};
  const std::vector<WorldId> worlds{1, 2, 3};
  const auto refuse = [&](ErrorCode code, const char* place, const char* words, MeshId of,
                          std::span<const Affine> some, std::span<const WorldId> in) {
    expect_error(code, place, words, [&] { scene.instances(of, some, in); });
    EXPECT_TRUE(scene.is_committed());
    EXPECT_EQ(scene.instance_count(), 1u);
    EXPECT_EQ(scene.next_instance(), 1u);
  };
  refuse(ErrorCode::kNotFound, "meshes[9]", "no such mesh", 9, maps, {});
  refuse(ErrorCode::kInvalidArgument, "instances[2].transform", "not finite", mesh, maps, {});
  refuse(ErrorCode::kInvalidArgument, "worlds", "3 worlds for 2 transforms", mesh, maps, worlds);
  EXPECT_EQ(scene.instances(mesh, {}), 1u);
  EXPECT_TRUE(scene.is_committed());
  const std::vector<Affine> right(3, Affine());
  EXPECT_EQ(scene.instances(mesh, right, worlds, 5), 1u);
  EXPECT_EQ(scene.instances(mesh), (std::vector<InstanceId>{0, 1, 2, 3}));
  EXPECT_EQ(scene.world(0), kAllWorlds);
  EXPECT_EQ(scene.world(3), 3u);
  EXPECT_EQ(scene.mask(2), 5u);
  EXPECT_EQ(scene.instances(mesh, right), 4u);
  EXPECT_EQ(scene.world(5), kAllWorlds);
  expect_error(ErrorCode::kNotFound, "instances[9]", "no such instance",
               [&] { scene.set_world(9, 0); });
}

}  // namespace
}  // namespace raysheaf::test
