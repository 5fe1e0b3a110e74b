// Calls with few rays, or with one: they go one by one, and where nothing has changed on the
// caller's thread.
#include <algorithm>
#include <atomic>
#include <thread>

#include "api/api_support.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

/// Rays of all kinds: from within, from far away, along axes, with limits.
std::vector<Ray> mixed_rays(std::size_t count, Random* random) {
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray = {random->in_box(5), 0, random->direction(), kInfinity};
    switch (random->below(6)) {
      case 0:
        ray.origin = ray.direction * -3000.0f + random->in_box(4);
        break;
      case 1:
        ray.direction = {0, 0, random->below(2) == 0 ? 1.0f : -1.0f};
        break;
      case 2:
        ray.t_min = random->unit(), ray.t_max = ray.t_min + 2 * random->unit();
        break;
      case 3:
        ray.direction = ray.direction * 1e-20f;
        break;
      default:
        break;
    }
  }
  return rays;
}

/// Two instances of a soup that has some triangles twice.
Scene two_soups(std::uint32_t threads = 2) {
  RandomSoup soup(400, 0);
  soup.positions.insert(soup.positions.end(), soup.positions.begin(), soup.positions.begin() + 300);
  Scene scene(Context({.threads = threads}));
  scene.add_soup(soup.positions, {.mask = 1});
  scene.add_soup(soup.positions, {.transform = translation({1, 0, 0}), .mask = 2});
  scene.commit();
  return scene;
}

/// The options for a batch of ray i only.
QueryOptions of_one(QueryOptions options, std::size_t i) {
  if (!options.ray_masks.empty()) options.ray_masks = options.ray_masks.subspan(i, 1);
  if (!options.skip.empty()) options.skip = options.skip.subspan(i, 1);
  if (!options.ray_worlds.empty()) options.ray_worlds = options.ray_worlds.subspan(i, 1);
  return options;
}

/// For all rays at once, and for each by itself.
void expect_brute_force(const Scene& scene, const std::vector<Ray>& rays, QueryOptions options) {
  const std::vector<Hit> hits = closest_hit(scene, rays, options);
  const std::vector<std::uint8_t> any = any_hit(scene, rays, options);
  const QueryOptions given = options;
  options.method = QueryMethod::kBrute;
  const std::vector<Hit> expected = closest_hit(scene, rays, options);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit single = closest_hit(scene, rays[i], of_one(given, i));
    EXPECT_TRUE(same(single, expected[i]))
        << i << ": " << shown(single) << "; " << shown(expected[i]);
    EXPECT_EQ(any_hit(scene, rays[i], of_one(given, i)), expected[i].prim_id != kInvalidId);
    EXPECT_TRUE(same(hits[i], expected[i]))
        << i << " of " << rays.size() << ": " << shown(hits[i]) << "; " << shown(expected[i]);
    EXPECT_EQ(any[i] != 0, expected[i].prim_id != kInvalidId);
  }
}

TEST(FewRays, HaveTheHitsOfBruteForce) {
  for_each_simd_target([](const char* target) {
    SCOPED_TRACE(target);
    const Scene scene = two_soups();
    Random random(11);
    for (const std::size_t count : {1u, 2u, 1u, 3u, 10u, 16u, 17u, 100u, 256u, 257u, 512u, 513u}) {
      const std::vector<Ray> rays = mixed_rays(count, &random);
      for (const std::uint32_t mask : {3u, 2u}) expect_brute_force(scene, rays, {.mask = mask});
    }
  });
}

TEST(FewRays, MeetOnlyTheHitsThatCount) {
  const Scene scene = two_soups();
  Random random(12);
  for (const std::size_t count : {1u, 20u, 300u, 500u}) {
    const std::vector<Ray> rays = mixed_rays(count, &random);
    std::vector<TriangleId> skip;
    std::vector<std::uint32_t> masks;
    for (const Hit& hit : closest_hit(scene, rays)) {
      skip.push_back(triangle_of(hit));
      masks.push_back(random.below(4));
    }
    for (const Sides sides : {Sides::kBoth, Sides::kFront, Sides::kBack}) {
      expect_brute_force(scene, rays, {.sides = sides, .skip = skip});
      expect_brute_force(scene, rays, {.sides = sides, .ray_masks = masks});
    }
  }
}

TEST(FewRays, SeeTheirWorlds) {
  Scene scene = two_soups();
  std::vector<WorldId> worlds;
  for (WorldId world = 0; world < 3; ++world) {
    (void)scene.instance(0, translation({static_cast<float>(world), 2, 0}), 3, world);
    worlds.insert(worlds.end(), {world, kAllWorlds, 7});
  }
  scene.commit();
  Random random(17);
  expect_brute_force(scene, mixed_rays(9, &random), {.ray_worlds = worlds});
}

TEST(FewRays, FollowChanges) {
  Scene scene = two_soups();
  Random random(13);
  const InstanceId moving = scene.instances(1).front();
  for (int round = 0; round < 5; ++round) {
    for (int call = 0; call < 3; ++call) expect_brute_force(scene, mixed_rays(7, &random), {});
    scene.set_transform(moving, translation(random.in_box(2)));
    scene.commit();
  }
  scene.remove_instance(moving);
  expect_error(ErrorCode::kWrongState, "scene", "commit",
               [&] { (void)closest_hit(scene, mixed_rays(7, &random)); });
  scene.commit();
  expect_brute_force(scene, mixed_rays(7, &random), {});
}

TEST(FewRays, CountTheSameWithAnyThreadsAndSayWhatIsPlanned) {
  Random random(14);
  const std::vector<Ray> rays = mixed_rays(400, &random);
  std::vector<QueryStatistics> all(2);
  for (const std::uint32_t threads : {1u, 2u}) {
    const Scene scene = two_soups(threads);
    (void)closest_hit(scene, rays, {.count_tests = true, .statistics = &all[threads - 1]});
  }
  EXPECT_GT(all[0].triangle_tests, 0u);
  EXPECT_EQ(all[0].triangle_tests, all[1].triangle_tests);
  EXPECT_EQ(all[0].ray_bound_tests, all[1].ray_bound_tests);
  EXPECT_EQ(all[0].plan.back(), "rays: each by itself, because they are few");
}

TEST(FewRays, AreValidatedAndStopped) {
  const Scene scene = two_soups();
  Random random(15);
  std::vector<Ray> rays = mixed_rays(9, &random);
  (void)closest_hit(scene, rays);
  const std::atomic<bool> stop = true;
  expect_error(ErrorCode::kCancelled, "", "",
               [&] { (void)closest_hit(scene, rays, {.stop = &stop}); });
  rays[4].direction = {};
  rays[7].t_min = kNaN;
  expect_error(ErrorCode::kInvalidData, "rays[4].direction", "zero",
               [&] { (void)closest_hit(scene, rays); });
  expect_error(ErrorCode::kInvalidData, "rays[4].direction", "zero",
               [&] { (void)any_hit(scene, rays); });
}

TEST(OneRay, HasTheErrorsOfABatch) {
  Scene scene = two_soups();
  const Ray right{{0, 0, -9}, 0, {0, 0, 1}, kInfinity};
  const auto refused = [&](ErrorCode code, const char* place, const char* words, const Ray& ray,
                           const QueryOptions& options = {}) {
    expect_error(code, place, words, [&] { (void)closest_hit(scene, ray, options); });
    expect_error(code, place, words, [&] { (void)any_hit(scene, ray, options); });
  };
  const std::vector<std::uint32_t> two(2);
  const std::atomic<bool> stop = true;
  for (int call = 0; call < 2; ++call) {
    Ray ray = right;
    ray.direction = {};
    refused(ErrorCode::kInvalidData, "ray.direction", "zero", ray);
    ray = right, ray.origin.y = kNaN;
    refused(ErrorCode::kInvalidData, "ray.origin", "finite", ray);
    ray = right, ray.t_min = -1;
    refused(ErrorCode::kInvalidData, "ray.t_min", "negative", ray);
    refused(ErrorCode::kInvalidArgument, "ray_masks", "2", right, {.ray_masks = two});
    refused(ErrorCode::kInvalidArgument, "rays_per_world", "", right, {.rays_per_world = 2});
    refused(ErrorCode::kCancelled, "", "", right, {.stop = &stop});
    (void)closest_hit(scene, right, {.check = false});
  }
  scene.remove(0);
  refused(ErrorCode::kWrongState, "scene", "commit", right);
}

TEST(OneRay, MissesAnEmptySceneAndCountsItsTests) {
  const Ray ray{{0, 0, -9}, 0, {0, 0, 1}, kInfinity};
  Scene empty;
  empty.commit();
  EXPECT_TRUE(same(closest_hit(empty, ray), Hit{}));
  EXPECT_FALSE(any_hit(empty, ray));
  QueryStatistics one, batch;
  const Scene scene = two_soups();
  (void)closest_hit(scene, ray, {.count_tests = true, .statistics = &one});
  (void)closest_hit(scene, std::span(&ray, 1), {.count_tests = true, .statistics = &batch});
  EXPECT_EQ(one.rays, 1u);
  EXPECT_EQ(one.ray_bound_tests, batch.ray_bound_tests);
  EXPECT_EQ(one.triangle_tests, batch.triangle_tests);
}

TEST(FewRays, OfManyThreadsAndLargeBatchesAtOnce) {
  Random random(16);
  const std::vector<Ray> rays = mixed_rays(3000, &random);
  const Scene scene = two_soups();
  const std::vector<Hit> expected = closest_hit(scene, rays, {.method = QueryMethod::kBrute});
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (std::size_t i = 0; i + 20 < rays.size(); i += 1 + t) {
        const std::size_t count = i % 500 == 0 ? rays.size() - i : 1 + i % 20;
        const auto hits = closest_hit(scene, std::span(rays).subspan(i, count));
        if (!std::equal(hits.begin(), hits.end(), expected.begin() + i, same)) ++wrong;
        if (!same(closest_hit(scene, rays[i]), expected[i])) ++wrong;
        if (any_hit(scene, rays[i]) != (expected[i].prim_id != kInvalidId)) ++wrong;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace raysheaf::test
