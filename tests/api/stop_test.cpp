// Queries that their callers cancel.
#include <atomic>
#include <chrono>
#include <thread>

#include "api/api_support.h"
#include "raysheaf/points.h"

namespace raysheaf::test {
namespace {

/// Whether `ask(options)` was cancelled after a request that came after `delay`.
template <class Options = QueryOptions, class Ask>
bool stopped(std::chrono::microseconds delay, Options options, const Ask& ask) {
  std::atomic<bool> stop = false;
  options.stop = &stop;
  std::thread other([&] {
    std::this_thread::sleep_for(delay);
    stop = true;
  });
  bool is_stopped = false;
  try {
    ask(options);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kCancelled) << error.what();
    is_stopped = true;
  }
  other.join();
  return is_stopped;
}

TEST(Stop, BeforeItBegins) {
  const RandomSoup moving(4, 4, 0.2f);
  Scene scene(Context({.threads = 2}));
  scene.add_soup(moving.positions);
  scene.commit();
  const std::atomic<bool> stop = true;
  for (const QueryMethod method : {QueryMethod::kDual, QueryMethod::kBrute})
    expect_error(ErrorCode::kCancelled, "", "stop",
                 [&] { (void)closest_hit(scene, moving.rays, {.method = method, .stop = &stop}); });
  const std::atomic<bool> go_on = false;
  EXPECT_EQ(closest_hit(scene, moving.rays, {.stop = &go_on}).size(), 4u);
}

// Without cancellation, it would take many seconds.
TEST(Stop, BruteForceEndsSoon) {
  const RandomSoup moving(20'000, 200'000, 0.2f);
  for (const std::uint32_t threads : {1u, 3u}) {
    Scene scene(Context({.threads = threads}));
    scene.add_soup(moving.positions);
    scene.commit();
    const QueryOptions brute{.method = QueryMethod::kBrute};
    constexpr std::chrono::milliseconds kDelay{10};
    EXPECT_TRUE(stopped(kDelay, brute, [&](const auto& options) {
      (void)closest_hit(scene, moving.rays, options);
    }));
    EXPECT_TRUE(stopped(kDelay, brute,
                        [&](const auto& options) { (void)any_hit(scene, moving.rays, options); }));
    EXPECT_TRUE(stopped(kDelay, brute,
                        [&](const auto& options) { (void)all_hits(scene, moving.rays, options); }));
  }
}

// Each ray hits everything: collecting the hits would take minutes and 40 gigabytes.
TEST(Stop, WithinOneTask) {
  constexpr std::uint32_t kLayers = 200'000;
  std::vector<Vec3> positions;
  for (std::uint32_t i = 0; i < kLayers; ++i) {
    const float z = 1 + 1e-5f * static_cast<float>(i);
    positions.insert(positions.end(), {{-5, -5, z}, {5, -5, z}, {0, 5, z}});
  }
  std::vector<Ray> rays(6000);
  for (std::size_t i = 0; i < rays.size(); ++i)
    rays[i] = {{1e-4f * static_cast<float>(i), 0, 0}, 0, {0, 0, 1}};
  for (const std::uint32_t threads : {1u, 3u}) {
    Scene scene(Context({.threads = threads}));
    scene.add_soup(positions);
    scene.commit();
    constexpr std::chrono::milliseconds kDelay{100};
    EXPECT_TRUE(
        stopped(kDelay, {}, [&](const auto& options) { (void)all_hits(scene, rays, options); }));
    std::vector<std::uint32_t> counts(rays.size());
    EXPECT_TRUE(stopped(kDelay, {},
                        [&](const auto& options) { hit_counts(scene, rays, counts, options); }));
  }
}

// Each of the six rays of each point crosses what lies beyond it in a large open surface: the
// points would take many seconds, and a thread's share of them more than one.
TEST(Stop, PointsOfAnOpenSurface) {
  const RandomSoup surface(30'000, 100'000, 1.0f);
  std::vector<Vec3> points;
  for (const Ray& ray : surface.rays) points.push_back(ray.origin);
  Scene scene(Context({.threads = 2}));
  scene.add_soup(surface.positions);
  scene.commit();
  (void)contains(scene, PointParts(std::span(points).first(2)));
  for (const QueryMethod method : {QueryMethod::kDual, QueryMethod::kBrute}) {
    const PointOptions asked{.method = method};
    const auto expect_soon = [&](const auto& ask) {
      const auto begin = std::chrono::steady_clock::now();
      EXPECT_TRUE(stopped<PointOptions>(std::chrono::milliseconds(50), asked, ask));
      EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(1500));
    };
    expect_soon([&](const auto& options) { (void)contains(scene, points, options); });
    expect_soon([&](const auto& options) { (void)signed_distance(scene, points, options); });
  }
}

// Wherever a query is cancelled (while it builds its tree, sorts, or traces), the next one gives
// the right answer.
TEST(Stop, TheSceneAnswersTheNextQuery) {
  RandomSoup moving(2'000, 4'000, 0.2f);
  Scene scene(Context({.threads = 2}));
  const MeshId mesh = scene.add_soup(moving.positions);
  scene.commit();
  int times = 0;
  for (int round = 0; round < 40; ++round) {
    for (Vec3& p : moving.positions) p = p * (round % 7 == 0 ? -1.1f : 0.99f);
    if (round % 5 == 0)
      scene.replace_soup(mesh, moving.positions);
    else
      scene.update(mesh, moving.positions);
    scene.commit();
    const auto delay = std::chrono::microseconds(10 * round);
    times += stopped(delay, {}, [&](const auto& options) {
      if (round % 3 == 0)
        (void)all_hits(scene, moving.rays, options);
      else
        (void)closest_hit(scene, moving.rays, options);
    });
    Scene fresh(Context({.threads = 2}));
    fresh.add_soup(moving.positions);
    fresh.commit();
    const auto hits = closest_hit(scene, moving.rays);
    ASSERT_TRUE(
        std::ranges::equal(hits, closest_hit(fresh, moving.rays),
                           [](auto& a, auto& b) { return a.t == b.t && a.prim_id == b.prim_id; }))
        << "round " << round;
  }
  RecordProperty("queries stopped", times);
  if (times == 0) GTEST_SKIP() << "no query was stopped in time";
}

}  // namespace
}  // namespace raysheaf::test
