// Several threads use one scene.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <future>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

#include "api/api_support.h"
#include "raysheaf/render.h"
#include "support/pictures.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

TEST(Threads, OfAContextServeItsUsers) {
  for (const std::uint32_t threads : {1u, 3u}) {
    const Context context({.threads = threads});
    for (const std::size_t grain : {std::size_t{0}, std::size_t{7}, std::size_t{5000}}) {
      std::vector<std::uint8_t> times(1000);
      context.for_each_block(times.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++times[i];
      });
      EXPECT_EQ(std::ranges::count(times, 1), 1000);
    }
    context.for_each_block(0, 1, [](std::size_t, std::size_t) { ADD_FAILURE(); });
    EXPECT_THROW(context.for_each_block(9, 2,
                                        [](std::size_t, std::size_t end) {
                                          if (end == 9) throw std::out_of_range("the last");
                                        }),
                 std::out_of_range);
  }
}

// Not fewer threads because another context has few, and without a word from oneTBB.
TEST(Threads, AContextHasTheThreadsThatItWasGiven) {
  const std::uint32_t cores = std::thread::hardware_concurrency();
  testing::internal::CaptureStderr();
  const Context few({.threads = 2});
  few.for_each_block(100, 1, [](std::size_t, std::size_t) {});
  for (const std::uint32_t threads : {cores + 3, 300u}) {
    const Context many({.threads = threads});
    std::mutex mutex;
    std::set<std::thread::id> here;
    std::atomic<std::size_t> number = 0;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    many.for_each_block(std::size_t{100} * threads, 1, [&](std::size_t, std::size_t) {
      {
        const std::lock_guard lock(mutex);
        here.insert(std::this_thread::get_id());
        number = here.size();
      }
      while (number < threads && std::chrono::steady_clock::now() < end) std::this_thread::yield();
    });
    EXPECT_EQ(number, threads);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Threads, QueriesOfOneSceneRunTogether) {
  const RandomSoup soup(300, 200);
  Scene scene(Context({.threads = 2}));
  scene.add_soup(soup.positions, {.mask = 1});
  scene.add_soup(soup.positions, {.transform = translation({1, 0, 0}), .mask = 2});
  scene.commit();
  std::vector<std::vector<Hit>> expected;
  for (const std::uint32_t mask : {1u, 2u, 3u})
    expected.push_back(
        closest_hit(scene, soup.rays, {.method = QueryMethod::kBrute, .mask = mask}));
  // The first query after a commit builds the tree.
  scene.set_transform(scene.instances(1).front(), translation({1, 0, 0}));
  scene.commit();
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (std::uint32_t round = 0; round < 6; ++round) {
        const std::uint32_t mask = 1 + (t + round) % 3;
        const auto method = round == 5 ? QueryMethod::kBrute : QueryMethod::kDual;
        const auto hits = closest_hit(scene, soup.rays, {.method = method, .mask = mask});
        if (!std::ranges::equal(hits, expected[mask - 1], same)) ++wrong;
        if (scene.mesh_count() != 2 || scene.bounds().min.x > scene.bounds().max.x) ++wrong;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

// Changes during queries are refused or made as a whole.
TEST(Threads, ChangesDuringAQueryAreRefused) {
  const RandomSoup soup(2000, 600);
  Scene scene(Context({.threads = 2}));
  const MeshId mesh = scene.add_soup(soup.positions);
  scene.commit();
  std::atomic<bool> done = false;
  std::atomic<int> strange = 0, queries = 0;
  std::thread other([&] {
    while (!done) {
      try {
        (void)closest_hit(scene, soup.rays, {.method = QueryMethod::kBrute});
        ++queries;
      } catch (const Error& error) {
        if (error.code() != ErrorCode::kWrongState) ++strange;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // gives the changes some time
    }
  });
  while (queries == 0) std::this_thread::yield();
  int refused = 0;
  for (int tries = 0; refused == 0 && tries < 100000; ++tries) {
    try {
      scene.update(mesh, soup.positions);
      scene.commit();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kWrongState) << error.what();
      EXPECT_EQ(error.sentence(), "the scene cannot change while a query runs");
      ++refused;
    }
    std::this_thread::yield();
  }
  EXPECT_GT(refused, 0);
  int removed = 0;
  while (removed == 0) {
    try {
      scene.remove(mesh);
      ++removed;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kWrongState) << error.what();
    }
  }
  done = true;
  other.join();
  EXPECT_EQ(strange, 0);
  EXPECT_EQ(scene.mesh_count(), 0u);
  scene.commit();
  EXPECT_EQ(first_hit(scene, along_z()).prim_id, kInvalidId);
}

// A query locks the scene's engine. While it waits for its own loop, its thread must not begin
// another body, and a query from outside takes its turn among the waiting threads.
TEST(Threads, BodiesOfALoopQueryOneScene) {
  const RandomSoup soup(5'000, 20'000, 0.2f);
  const Context context({.threads = 3});
  Scene scene(context);
  scene.add_soup(soup.positions);
  scene.commit();
  std::vector<Hit> expected(soup.rays.size());
  closest_hit(scene, soup.rays, expected);
  std::atomic<int> wrong = 0, bodies = 0;
  std::atomic<bool> done = false;
  std::thread outside([&] {
    while (!done)
      if (!std::ranges::equal(closest_hit(scene, soup.rays), expected, same)) ++wrong;
  });
  const auto all = std::async(std::launch::async, [&] {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    for (std::size_t round = 0; std::chrono::steady_clock::now() < end; ++round) {
      context.for_each_block(8, 1, [&](std::size_t begin, std::size_t last) {
        for (std::size_t i = begin; i < last; ++i) {
          // Loops of uneven duration: some wait while others begin.
          if ((i + round) % 2 == 0)
            std::this_thread::sleep_for(std::chrono::microseconds((i + round) * 7919 % 3000));
          std::vector<Hit> hits(soup.rays.size());
          closest_hit(scene, soup.rays, hits);
          if (!std::ranges::equal(hits, expected, same)) ++wrong;
          ++bodies;
        }
      });
    }
  });
  if (all.wait_for(std::chrono::seconds(120)) != std::future_status::ready) {
    ADD_FAILURE() << "the threads wait for each other, after " << bodies << " bodies";
    std::_Exit(1);  // the threads never end
  }
  done = true;
  outside.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(bodies, 8);
}

TEST(Threads, ScenesOfOneContextAreIndependent) {
  const RandomSoup soup(200, 100);
  const Context context({.threads = 2});
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&, t] {
      Scene scene(context);
      const auto shift = static_cast<float>(t);
      const MeshId mesh = scene.add_soup(soup.positions);
      for (int frame = 0; frame < 5; ++frame) {
        scene.set_transform(scene.instances(mesh)[0], translation({shift, 0, 0}));
        scene.commit();
        const auto hits = closest_hit(scene, soup.rays);
        const auto truth = closest_hit(scene, soup.rays, {.method = QueryMethod::kBrute});
        if (!std::ranges::equal(hits, truth, same)) ++wrong;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

/// The renderer's groups of pixels, one per thread, make the same picture, counts and plans.
TEST(Threads, RenderAndCountTheSameInAnyNumber) {
  Material glass;
  glass.transmission = 1;
  glass.roughness = 0;
  RenderOptions options = small_options(200);
  options.height = 150;
  options.count_pixel_tests = true;
  options.samples = 2;
  const auto rendered = [&](std::uint32_t threads) {
    options.threads = threads;
    return render(ball_on_floor(glass), options);
  };
  const RenderResult one = rendered(1), many = rendered(5);
  EXPECT_TRUE(same_bits(one.beauty, many.beauty));
  EXPECT_EQ(one.tests, many.tests);
  const auto &ours = one.statistics.batches, &theirs = many.statistics.batches;
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_EQ(ours[i].rays, theirs[i].rays);
    EXPECT_EQ(ours[i].hits, theirs[i].hits);
    EXPECT_EQ(ours[i].total_tests(), theirs[i].total_tests());
    EXPECT_EQ(ours[i].plan, theirs[i].plan);
  }
}

TEST(Threads, TheSimdTargetIsOneOfThisMachine) {
  const std::string used = simd_target();
  bool known = false;
  for_each_simd_target([&](const char* target) { known = known || used == target; });
  EXPECT_TRUE(known) << used;
}

}  // namespace
}  // namespace raysheaf::test
