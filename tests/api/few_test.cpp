// Calls with few rays: they go one by one, and where nothing has changed on the caller's thread.
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

void expect_brute_force(const Scene& scene, const std::vector<Ray>& rays, QueryOptions options) {
  const std::vector<Hit> hits = closest_hit(scene, rays, options);
  const std::vector<std::uint8_t> any = any_hit(scene, rays, options);
  options.method = QueryMethod::kBrute;
  const std::vector<Hit> expected = closest_hit(scene, rays, options);
  for (std::size_t i = 0; i < rays.size(); ++i) {
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
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace raysheaf::test
