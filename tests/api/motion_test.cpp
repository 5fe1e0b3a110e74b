// Instances and meshes that move while rays are cast: a ray with a time gets the answers of a scene
// with the transforms and the vertices of that time.
#include <cmath>
#include <map>

#include "api/api_support.h"
#include "api/scene/context_impl.h"
#include "api/scene/scene_impl.h"
#include "emulated/open_emulated.h"
#include "raysheaf/hit_points.h"
#include "raysheaf/points.h"
#include "support/guarded_memory.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

Affine any_stand(Random& random) {
  Affine map = rotation(random.direction(), random.between(-3, 3));
  Affine shear;
  shear.m[0][1] = 1.5f, shear.m[2][0] = -0.7f;
  const float tiny = std::exp(random.between(-14, 0)), huge = std::exp(random.between(0, 14));
  switch (random.below(9)) {
    case 0:
      map = compose(map, scaling({1, 0.3f, -1.5f}));
      break;
    case 1:
      map = compose(map, shear);
      break;
    case 2:
      map = compose(map, scaling({1, 0, 1}));
      break;
    case 3:
      map = compose(map, scaling({tiny, tiny, tiny}));
      break;
    case 4:
      map = compose(map, scaling({huge, huge, huge}));
      break;
    case 5:
      map = {};
      break;
    default:
      break;
  }
  const Vec3 to = random.in_box(random.below(9) == 0 ? 1e5f : 4.0f);
  map.m[0][3] = to.x, map.m[1][3] = to.y, map.m[2][3] = to.z;
  return map;
}

/// Most move: with two to four transforms, a little or to anywhere.
void set_motion(Scene* scene, InstanceId instance, Random& random) {
  std::vector<Affine> maps{any_stand(random)};
  const std::size_t each = random.below(4) == 0 ? 1 : 2 + random.below(3);
  while (maps.size() < each) {
    Affine next = random.below(2) == 0 ? any_stand(random) : maps.back();
    next.m[random.below(3)][3] += random.between(-0.5f, 0.5f);
    maps.push_back(random.below(6) == 0 ? compose(next, scaling({-1, 1, 1})) : next);
  }
  scene->set_transforms({&instance, 1}, maps, each);
  EXPECT_EQ(scene->transforms(instance).size(), each);
}

/// Two to four positions of each vertex, a little or anywhere apart; or one.
void set_vertices(Scene* scene, MeshId mesh, Random& random) {
  const std::vector<Vec3> first = scene->positions_at(mesh, 0);
  const std::size_t times = random.below(4) == 0 ? 1 : 2 + random.below(3);
  std::vector<Vec3> all = first;
  while (all.size() < times * first.size()) {
    const float reach = std::exp(random.between(-12, 1));
    const bool together = random.below(3) == 0;
    Vec3 by = random.in_box(reach);
    for (std::size_t i = 0; i < first.size(); ++i) {
      if (!together) by = random.in_box(reach);
      all.push_back(all[all.size() - first.size()] + by);
    }
  }
  scene->update(mesh, all, times);
  EXPECT_EQ(scene->time_count(mesh), times);
}

/// Cubes, soups and flat ones, most of which change their shapes, in three worlds and in all.
void fill_moving(Scene* scene, std::size_t instances, Random& random) {
  const Cube cube;
  scene->add(cube.positions, cube.triangles, {.place = false});
  scene->add_soup(RandomSoup(40, 0).positions, {.place = false});
  const Square square;
  scene->add(square.positions, square.triangles);
  for (const MeshId mesh : scene->meshes()) set_vertices(scene, mesh, random);
  for (std::size_t i = 0; i < instances; ++i) {
    const InstanceId one =
        scene->instance(random.below(3), Affine(), 1u << random.below(3),
                        random.below(4) == 0 ? kAllWorlds : WorldId{random.below(3)});
    set_motion(scene, one, random);
  }
  scene->commit();
}

/// The scene as it is at a time.
Scene still_at(const Scene& scene, float time) {
  Scene still = scene.copy();
  for (const MeshId mesh : scene.meshes()) {
    still.update(mesh, scene.positions_at(mesh, time));
    for (const InstanceId instance : scene.instances(mesh))
      still.set_transform(instance, transform_at(scene.transforms(instance), time));
  }
  still.commit();
  return still;
}

struct TimedRays {
  std::vector<Ray> rays;
  std::vector<float> times;
};

/// Half of them at a corner or an edge where it is at their time.
TimedRays any_timed(const Scene& scene, std::size_t count, Random& random) {
  constexpr float kTimes[] = {0, 1, 0.5f, 1.0f / 3, -0.0f};
  TimedRays all;
  std::vector<std::pair<MeshId, InstanceId>> ids;
  for (const MeshId mesh : scene.meshes())
    for (const InstanceId instance : scene.instances(mesh)) ids.emplace_back(mesh, instance);
  while (all.rays.size() < count) {
    const float time = random.below(2) == 0   ? random.unit()
                       : random.below(3) != 0 ? static_cast<float>(random.below(6)) / 8
                                              : kTimes[random.below(std::size(kTimes))];
    Ray ray{random.in_box(6), 0, random.direction(), random.below(4) == 0 ? 5 : kInfinity};
    const auto [mesh, instance] = ids[random.below(static_cast<std::uint32_t>(ids.size()))];
    if (random.below(2) == 0 && scene.vertex_count(mesh) != 0) {
      const std::vector<Vec3> positions = scene.positions_at(mesh, time);
      const auto any = [&] {
        return positions[random.below(static_cast<std::uint32_t>(positions.size()))];
      };
      const Affine map = transform_at(scene.transforms(instance), time);
      Vec3 to = transform_point(map, any());
      if (random.below(2) == 0) to = (to + transform_point(map, any())) * 0.5f;
      if (random.below(3) == 0) ray.origin = ray.origin + to;
      ray.direction = to - ray.origin, ray.t_max = kInfinity;
      if (ray.direction.x == 0 && ray.direction.y == 0 && ray.direction.z == 0) continue;
    }
    all.rays.push_back(ray);
    all.times.push_back(time);
  }
  return all;
}

/// Queries of all kinds have the answers of still scenes. `given`: options but times.
void expect_still(const Scene& scene, const TimedRays& timed, const QueryOptions& given) {
  QueryOptions options = given;
  options.ray_times = timed.times;
  const std::vector<Hit> hits = closest_hit(scene, timed.rays, options);
  const std::vector<std::uint8_t> occluded = any_hit(scene, timed.rays, options);
  const std::vector<std::uint32_t> counts = hit_counts(scene, timed.rays, options);
  const HitRows all = all_hits(scene, timed.rays, options);
  const std::vector<HitPoint> points = hit_points(scene, timed.rays, hits, timed.times);
  std::map<float, std::vector<std::size_t>> at_times;
  for (std::size_t i = 0; i < timed.times.size(); ++i) at_times[timed.times[i]].push_back(i);
  for (const auto& [time, items] : at_times) {
    SCOPED_TRACE(time);
    const Scene still = still_at(scene, time);
    QueryOptions alone = given;
    alone.method = QueryMethod::kBrute;
    std::vector<Ray> own;
    std::vector<WorldId> worlds;
    for (const std::size_t i : items) {
      own.push_back(timed.rays[i]);
      if (!given.ray_worlds.empty()) worlds.push_back(given.ray_worlds[i]);
    }
    alone.ray_worlds = worlds;
    const HitRows rows = all_hits(still, own, alone);
    std::vector<Hit> found;
    for (std::size_t k = 0; k < items.size(); ++k) {
      const std::size_t i = items[k];
      found.push_back(rows[k].empty() ? Hit{} : rows[k].front());
      ASSERT_TRUE(same(hits[i], found[k])) << shown(hits[i]) << ", not " << shown(found[k]);
      ASSERT_EQ(occluded[i], rows[k].empty() ? 0 : 1);
      ASSERT_EQ(counts[i], rows[k].size());
      ASSERT_TRUE(std::ranges::equal(all[i], rows[k], same));
    }
    const std::vector<HitPoint> right = hit_points(still, own, found);
    for (std::size_t k = 0; k < items.size(); ++k)
      ASSERT_EQ(std::memcmp(&points[items[k]], &right[k], sizeof(HitPoint)), 0);
  }
}

constexpr QueryMethod kMethods[] = {QueryMethod::kBrute, QueryMethod::kDual};

void expect_right(const Scene& scene, std::size_t count, Random& random) {
  TimedRays timed = any_timed(scene, count, random);
  std::vector<WorldId> worlds;
  for (std::size_t i = 0; i < count; ++i)
    worlds.push_back(random.below(5) == 0 ? kAllWorlds : random.below(4));
  for (const QueryMethod method : kMethods) {
    SCOPED_TRACE(static_cast<int>(method));
    QueryOptions options;
    options.method = method;
    if (random.below(2) == 0) options.sides = random.below(2) == 0 ? Sides::kFront : Sides::kBack;
    if (random.below(2) == 0) options.mask = 1 + random.below(7);
    expect_still(scene, timed, options);
    options.ray_worlds = worlds;
    expect_still(scene, timed, options);
  }
}

TEST(Motion, IsTheSceneOfEachTime) {
  Random random(1);
  for (const std::size_t instances : {1, 3, 12, 12, 12, 90}) {
    Scene scene(Context({.threads = 2}));
    fill_moving(&scene, instances, random);
    expect_right(scene, 160, random);
  }
}

TEST(Motion, InSlicesOfTime) {
  Random random(8);
  Scene scene(Context({.threads = 2}));
  fill_moving(&scene, 7, random);  // 512 rays a slice
  TimedRays timed = any_timed(scene, 2500, random);
  for (float& time : timed.times) time = std::floor(time * 64) / 64;
  expect_still(scene, timed, {});
  std::ranges::sort(timed.times);
  expect_still(scene, timed, {.sides = Sides::kFront});
}

TEST(Motion, OnEverySimdTarget) {
  Random random(2);
  Scene scene;
  fill_moving(&scene, 12, random);
  for_each_simd_target([&](const char* target) {
    SCOPED_TRACE(target);
    expect_right(scene, 80, random);
  });
}

TEST(Motion, FollowsChanges) {
  Random random(3);
  Scene scene(Context({.threads = 2}));
  fill_moving(&scene, 10, random);
  for (int step = 0; step < 16; ++step) {
    SCOPED_TRACE(step);
    const std::vector<InstanceId> ids = instances_of(scene);
    const InstanceId one = ids[random.below(static_cast<std::uint32_t>(ids.size()))];
    switch (random.below(6)) {
      case 0:
        scene.set_transform(one, any_stand(random));
        EXPECT_EQ(scene.transforms(one).size(), 1u);
        break;
      case 1:
        if (ids.size() > 3) scene.remove_instance(one);
        break;
      case 2:
        scene.set_transform(one, any_stand(random), any_stand(random));
        break;
      case 3:
        scene.update(1, RandomSoup(40, 0, random.between(0.1f, 1)).positions);
        EXPECT_EQ(scene.time_count(1), 1u);
        break;
      case 4:
        set_vertices(&scene, random.below(3), random);
        break;
      default:
        for (const InstanceId id : ids) set_motion(&scene, id, random);
    }
    scene.commit();
    if (random.below(2) == 0) scene = scene.copy();
    expect_right(scene, 60, random);
  }
}

TEST(Motion, IsAtItsBeginWithoutTimes) {
  Random random(4);
  Scene scene;
  fill_moving(&scene, 9, random);
  const Scene still = still_at(scene, 0);
  const TimedRays timed = any_timed(scene, 200, random);
  const std::vector<Hit> hits = closest_hit(scene, timed.rays),
                         right = closest_hit(still, timed.rays);
  EXPECT_TRUE(std::ranges::equal(hits, right, same));
  const std::vector<float> begin(timed.rays.size(), 0.0f);
  EXPECT_TRUE(
      std::ranges::equal(closest_hit(scene, timed.rays, {.ray_times = begin}), right, same));
  EXPECT_EQ(closest_point(scene, std::vector<Vec3>{{1, 2, 3}})[0].distance,
            closest_point(still, std::vector<Vec3>{{1, 2, 3}})[0].distance);
  EXPECT_EQ(scene.bounds().max.x, still.bounds().max.x);
}

TEST(Motion, WhereItIsPlacedTheTimesOfAStillSceneDoNotMatter) {
  Scene scene;
  const Square square;
  scene.add(square.positions, square.triangles);
  scene.commit();
  const std::vector<Ray> rays(500, along_z());
  std::vector<float> times(500, 0.3f);
  QueryStatistics statistics;
  QueryOptions options{.statistics = &statistics};
  options.ray_times = times;
  for (const Hit& hit : closest_hit(scene, rays, options)) EXPECT_EQ(hit.t, 10);
  for (const std::string& sentence : statistics.plan)
    EXPECT_EQ(sentence.find("times"), std::string::npos) << sentence;
  scene.set_transform(0, Affine(), translation({0, 0, 2}));
  scene.commit();
  times.assign(500, 0.5f);
  for (const Hit& hit : closest_hit(scene, rays, options)) EXPECT_EQ(hit.t, 11);
  EXPECT_NE(statistics.plan.front().find("rays have times"), std::string::npos);
}

/// Many triangles, whose neighbours move alike, turn about each other, or go their own ways.
TEST(Motion, OfMeshesWithManyLeaves) {
  Random random(9);
  for (int n = 0; n < 6; ++n) {
    SCOPED_TRACE(n);
    Scene scene(Context({.threads = 2}));
    const std::vector<Vec3> begin = RandomSoup(2000, 0, 0.2f).positions;
    const Affine turn = rotation(random.direction(), random.between(0.1f, 3));
    std::vector<Vec3> end = begin;
    for (Vec3& p : end) p = n % 3 == 2 ? p + random.in_box(0.5f) : transform_point(turn, p);
    const MeshId mesh = scene.add_soup(begin, {.storage = Storage::kShare});
    scene.update(mesh, begin, end);
    if (n > 2) set_motion(&scene, scene.instance(mesh, Affine()), random);
    scene.commit();
    TimedRays timed = any_timed(scene, 1500, random);
    for (float& time : timed.times) time = std::floor(time * 16) / 16;
    expect_still(scene, timed, {});
  }
}

TEST(Motion, OnDevicesByTheCpu) {
  const Executor executor(2);
  GuardedMemory memory;
  const Context context =
      ContextAccess::with_backend({.device = Device::kCuda}, open_emulated(executor, memory));
  Random random(5);
  Scene scene(context);
  fill_moving(&scene, 6, random);
  expect_right(scene, 60, random);
}

TEST(Motion, TransformsAreMixedAsStated) {
  Random random(6);
  for (int n = 0; n < 3000; ++n) {
    std::vector<Affine> maps(1 + random.below(5));
    for (Affine& map : maps) map = any_stand(random);
    const auto steps = static_cast<double>(maps.size() - 1);
    const float time = random.unit();
    const auto j = static_cast<std::size_t>(time * steps);
    const double f = time * steps - static_cast<double>(j);
    const Affine mixed = transform_at(maps, time);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) {
        const double a = maps[j].m[r][c], b = maps[std::min(j + 1, maps.size() - 1)].m[r][c];
        const double left = (1 - f) * a, right = f * b;
        EXPECT_EQ(mixed.m[r][c], f == 0 ? maps[j].m[r][c] : static_cast<float>(left + right));
      }
    EXPECT_EQ(transform_at(maps, 0).m, maps.front().m);
    EXPECT_EQ(transform_at(maps, 1).m, maps.back().m);
  }
}

TEST(Motion, VerticesAreMixedAsTransformsAre) {
  Random random(7);
  for (int n = 0; n < 300; ++n) {
    Scene scene;
    const Square square;
    const MeshId mesh = scene.add(square.positions, square.triangles);
    std::vector<Vec3> all;
    const std::size_t times = 1 + random.below(5);
    while (all.size() < 4 * times) all.push_back(random.in_box(9));
    scene.update(mesh, all, times);
    const float time = random.unit();
    const std::vector<Vec3> there = scene.positions_at(mesh, time);
    for (std::size_t i = 0; i < 4; ++i) {
      std::vector<Affine> maps;
      for (std::size_t k = 0; k < times; ++k) maps.push_back(translation(all[4 * k + i]));
      const Affine map = transform_at(maps, time);
      EXPECT_EQ(there[i].x, map.m[0][3]);
      EXPECT_EQ(there[i].y, map.m[1][3]);
      EXPECT_EQ(there[i].z, map.m[2][3]);
    }
    EXPECT_EQ(scene.positions(mesh, times - 1)[3].z, all.back().z);
    EXPECT_EQ(scene.positions_at(mesh, 1)[3].z, all.back().z);
  }
}

TEST(Motion, RefusesVerticesThatAreWrong) {
  Scene scene;
  const Square square;
  const MeshId mesh = scene.add(square.positions, square.triangles);
  scene.commit();
  const std::vector<Vec3> three(3), twelve(12);
  std::vector<Vec3> far = square.positions, wrong = square.positions;
  far[2].y = 1e18f, wrong[1].x = kNaN;
  const auto refuse = [&](ErrorCode code, const char* place, const char* words,
                          const std::function<void()>& body) {
    expect_error(code, place, words, body);
    EXPECT_EQ(scene.time_count(mesh), 1u);
    EXPECT_TRUE(scene.is_committed());
  };
  refuse(ErrorCode::kInvalidArgument, "positions", "12 positions for 0 times",
         [&] { scene.update(mesh, twelve, 0); });
  refuse(ErrorCode::kInvalidArgument, "positions", "12 positions for 5 times",
         [&] { scene.update(mesh, twelve, 5); });
  refuse(ErrorCode::kInvalidArgument, "meshes[0].positions",
         "6 vertices are given, but the mesh has 4", [&] { scene.update(mesh, twelve, 2); });
  refuse(ErrorCode::kInvalidArgument, "meshes[0].positions", "3 vertices are given",
         [&] { scene.update(mesh, square.positions, three); });
  refuse(ErrorCode::kInvalidData, "meshes[0].times[1].positions[1]", "not finite",
         [&] { scene.update(mesh, square.positions, wrong); });
  refuse(ErrorCode::kInvalidArgument, "meshes[0].times[1]", "positions at 1 times",
         [&] { static_cast<void>(scene.positions(mesh, 1)); });
  refuse(ErrorCode::kInvalidArgument, "time", "not from 0 to 1",
         [&] { static_cast<void>(scene.positions_at(mesh, 1.5f)); });

  scene.update(mesh, square.positions, far);
  scene.commit();
  scene.set_transform(0, scaling({2, 2, 2}));
  expect_error(ErrorCode::kInvalidData, "instances[0].transform", "farther out than 1e18",
               [&] { scene.commit(); });
  scene.update(mesh, square.positions);
  scene.commit();
}

TEST(Motion, RefusesWhatIsWrong) {
  Scene scene;
  const Square square;
  scene.add(square.positions, square.triangles);
  scene.commit();
  const InstanceId one = 0;
  const std::vector<Affine> three(3), not_finite{Affine(), scaling({1, kNaN, 1})};
  const auto refuse = [&](const char* place, const char* words, std::span<const Affine> maps,
                          std::size_t each) {
    expect_error(ErrorCode::kInvalidArgument, place, words, [&] {
      scene.set_transforms({&one, 1}, maps, each);
    });
    EXPECT_TRUE(scene.is_committed());
  };
  refuse("transforms", "3 transforms for 1 instances, 2 each", three, 2);
  refuse("transforms", "3 transforms for 1 instances, 0 each", three, 0);
  refuse("transforms", "3 transforms for 1 instances", three, 1);
  refuse("instances[0].transform", "not finite", not_finite, 2);

  const std::vector<Ray> rays(3, along_z());
  const auto refuse_times = [&](ErrorCode code, const char* place, const char* words,
                                const std::vector<float>& times) {
    QueryOptions options;
    options.ray_times = times;
    expect_error(code, place, words, [&] { static_cast<void>(closest_hit(scene, rays, options)); });
  };
  refuse_times(ErrorCode::kInvalidArgument, "ray_times", "2 are given for 3 rays", {0, 1});
  refuse_times(ErrorCode::kInvalidData, "ray_times[1]", "not from 0 to 1", {0, 1.5f, 2});
  refuse_times(ErrorCode::kInvalidData, "ray_times[2]", "not from 0 to 1", {0, 1, kNaN});
  refuse_times(ErrorCode::kInvalidData, "ray_times[0]", "not from 0 to 1", {-1e-9f, 1, 1});
  const std::vector<Hit> hits = closest_hit(scene, rays);
  expect_error(ErrorCode::kInvalidData, "times[1]", "not from 0 to 1", [&] {
    static_cast<void>(hit_points(scene, rays, hits, std::vector<float>{0, 2, 0}));
  });

  scene.set_transform(0, Affine(), translation({2e18f, 0, 0}));
  expect_error(ErrorCode::kInvalidData, "instances[0].transform", "farther out than 1e18",
               [&] { scene.commit(); });
  scene.set_transform(0, Affine(), translation({2, 0, 0}));
  scene.commit();
}

}  // namespace
}  // namespace raysheaf::test
