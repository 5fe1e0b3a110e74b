// Processes that share rays or geometry give the bits of a single process, however work is divided,
// and one's failure stops all. The processes are threads here; tests/app/mpi_test.cpp starts real
// ones.
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <numeric>

#include "api/scene/context_impl.h"
#include "emulated/open_emulated.h"
#include "ranks/share.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/query.h"
#include "raysheaf/render.h"
#include "raysheaf/stream.h"
#include "tests/support/pictures.h"
#include "tests/support/random.h"
#include "tests/support/thread_ranks.h"

namespace raysheaf::test {
namespace {

const std::vector<std::string> kNoErrors(3);

TEST(Ranks, CombineAndHearRankZero) {
  const auto errors = run_ranks(3, [](const auto& ranks) {
    std::vector<std::uint64_t> sums{ranks->rank() + 1, 10};
    add(*ranks, sums);
    EXPECT_EQ(sums, (std::vector<std::uint64_t>{6, 30}));
    std::vector<std::uint8_t> bits(3);
    bits[ranks->rank()] = 7;
    unite(*ranks, std::span(bits));
    EXPECT_EQ(bits, (std::vector<std::uint8_t>{7, 7, 7}));
    std::uint32_t word = ranks->rank() + 5;
    ranks->broadcast(std::as_writable_bytes(std::span(&word, 1)));
    EXPECT_EQ(word, 5u);
  });
  EXPECT_EQ(errors, kNoErrors);
}

TEST(Ranks, TakeEachPieceOnceAndAgain) {
  const auto errors = run_ranks(3, [](const auto& ranks) {
    for (const std::size_t count : {0u, 1u, 100'000u, 8192u, 5u}) {
      std::vector<std::uint64_t> times(count);
      share_out(*ranks, pieces_of(count, ranks->size()), [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++times[i];
      });
      add(*ranks, times);
      EXPECT_EQ(times, std::vector<std::uint64_t>(count, 1));
    }
  });
  EXPECT_EQ(errors, kNoErrors);
}

TEST(Ranks, OneFailureIsEveryones) {
  for (std::uint32_t who = 0; who < 3; ++who) {
    const auto errors = run_ranks(3, [who](const auto& ranks) {
      if (ranks->rank() == who) throw Error(ErrorCode::kIo, "cannot be read", "block 3");
      share_out(*ranks, pieces_of(1'000'000'000, 3), [](std::size_t, std::size_t) {});
      ranks->combine({}, 1, nullptr);
      ADD_FAILURE() << "no rank reported the failure";
    });
    const std::string sentence = "rank " + std::to_string(who) + ": block 3: cannot be read";
    EXPECT_EQ(errors, std::vector<std::string>(3, sentence));
  }
}

RenderOptions small_frame(Method method) {
  RenderOptions options;
  options.width = 192;
  options.height = 128;
  options.primary = Primary::kTrace;
  options.method = method;
  options.threads = 1;
  options.count_pixel_tests = true;
  return options;
}

/// The names of the layers that differ.
std::string differing(const RenderResult& a, const RenderResult& b) {
  std::string names = a.exposure == b.exposure ? "" : "exposure ";
  const auto compare = [&](const char* name, const auto& x, const auto& y) {
    const bool same =
        x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
    if (!same) names += std::string(name) + " ";
  };
  compare("beauty", a.beauty, b.beauty);
  compare("position", a.position, b.position);
  compare("normal", a.normal, b.normal);
  compare("albedo", a.albedo, b.albedo);
  compare("specular", a.specular, b.specular);
  compare("shadow", a.shadow, b.shadow);
  compare("ids", a.ids, b.ids);
  return names;
}

/// Expects that the counts of all processes add up to those of a single one.
void expect_same_counts(const FrameStatistics& shared, const FrameStatistics& alone) {
  ASSERT_EQ(shared.batches.size(), alone.batches.size());
  for (std::size_t i = 0; i < alone.batches.size(); ++i) {
    const BatchStatistics &a = shared.batches[i], &b = alone.batches[i];
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.bounce, b.bounce);
    EXPECT_EQ(a.rays, b.rays);
    EXPECT_EQ(a.hits, b.hits);
    EXPECT_EQ(a.total_tests(), b.total_tests());
  }
}

TEST(Ranks, PicturesByRaysHaveTheSameBits) {
  SceneDescription scene = builtin_scene("cornell");
  add_curtain(&scene, 0, 1);
  for (const Method method : {Method::kDual, Method::kCrsh, Method::kGl10}) {
    const RenderOptions options = small_frame(method);
    const RenderResult alone = render(scene, options);
    const auto errors = run_ranks(3, [&](const auto& ranks) {
      const RenderResult shared = render(distributed({Device::kCpu, 1}, ranks), scene, options);
      EXPECT_EQ(differing(shared, alone), "") << to_string(method);
      ASSERT_EQ(shared.statistics.batches.size(), alone.statistics.batches.size());
      for (std::size_t i = 0; i < alone.statistics.batches.size(); ++i) {
        const BatchStatistics &a = shared.statistics.batches[i], &b = alone.statistics.batches[i];
        EXPECT_EQ(a.rays, b.rays);
        EXPECT_EQ(a.hits, b.hits);
        EXPECT_EQ(a.levels.size(), b.levels.size());
        EXPECT_GT(a.total_tests(), 0u);
      }
      const float tests = std::accumulate(shared.tests.begin(), shared.tests.end(), 0.0f);
      EXPECT_GT(tests, 0);
    });
    EXPECT_EQ(errors, kNoErrors) << to_string(method);
  }
}

/// Each group of primary rays is traced to the end by one process.
TEST(Ranks, PicturesByGroupsHaveTheSameBitsAndCounts) {
  RenderOptions options = small_frame(Method::kDual);
  options.bounces = 2;
  for (const bool rasters : {false, true}) {
    options.width = rasters ? 320 : 333;  // tiles, or rows
    options.height = rasters ? 256 : 200;
    options.samples = rasters ? 1 : 3;
    options.primary = rasters ? Primary::kRaster : Primary::kTrace;
    if (rasters) options.ambient = Vec3{0.1f, 0.2f, 0.3f};
    SceneDescription scene = builtin_scene("office");
    if (!rasters) add_curtain(&scene, 0, 1);
    const RenderResult alone = render(scene, options);
    for (const std::uint32_t processes : {1u, 2u, 5u}) {
      SCOPED_TRACE(processes);
      std::atomic<std::uint64_t> looks{0};
      const auto errors = run_ranks(processes, [&](const auto& ranks) {
        const auto threads = 1 + ranks->rank() % 2;
        RenderOptions here = options;
        here.on_sample = [&](const RenderResult& result) { return ++looks, result.samples < 9; };
        here.progress = [&](const Progress& p) { return p.done <= p.total; };
        const RenderResult shared =
            render(distributed({Device::kCpu, threads}, ranks), scene, here);
        EXPECT_EQ(differing(shared, alone), "");
        EXPECT_EQ(shared.tests, alone.tests);
        expect_same_counts(shared.statistics, alone.statistics);
      });
      EXPECT_EQ(errors, std::vector<std::string>(processes));
      EXPECT_EQ(looks, rasters ? 0u : 2 * processes);
    }
  }
}

/// Each process's device has the whole frame and traces parts of it.
TEST(Ranks, PicturesOnDevicesHaveTheSameBits) {
  SceneDescription scene = builtin_scene("cornell");
  add_curtain(&scene, 0, 1);
  for (const Method method :
       {Method::kBrute, Method::kDual, Method::kRah, Method::kCrsh, Method::kGl10}) {
    SCOPED_TRACE(to_string(method));
    RenderOptions options = small_frame(method);
    options.width = 96;
    options.height = 64;
    options.bounces = 2;
    options.count_pixel_tests = method == Method::kDual;
    options.early_out = method == Method::kGl10;
    options.samples = method == Method::kDual ? 3 : 1;
    if (method == Method::kCrsh) options.primary = Primary::kRaster;
    const RenderResult alone = render(scene, options);
    for (const std::uint32_t processes : {1u, 3u}) {
      SCOPED_TRACE(processes);
      const auto errors = run_ranks(processes, [&](const auto& ranks) {
        const Executor executor(1);
        HostAllocator memory;
        const Context context =
            ContextAccess::with_backend({Device::kCuda, 1}, open_emulated(executor, memory), ranks);
        const RenderResult shared = render(context, scene, options);
        EXPECT_EQ(differing(shared, alone), "");
        ASSERT_EQ(shared.statistics.batches.size(), alone.statistics.batches.size());
        std::size_t told = 0;
        for (std::size_t i = 0; i < alone.statistics.batches.size(); ++i) {
          const BatchStatistics& batch = shared.statistics.batches[i];
          EXPECT_EQ(batch.rays, alone.statistics.batches[i].rays);
          EXPECT_EQ(batch.hits, alone.statistics.batches[i].hits);
          for (const std::string& sentence : batch.plan)
            told += sentence.find("groups of primary hits were followed here") != sentence.npos;
        }
        EXPECT_EQ(told, processes > 1 ? 1u : 0u);
      });
      EXPECT_EQ(errors, std::vector<std::string>(processes));
    }
  }
}

TEST(Ranks, PicturesByGeometryHaveTheSameBits) {
  const SceneDescription scene = builtin_scene("cornell");
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(scene, &blocks, 100));
  const RenderOptions options = small_frame(Method::kDual);
  StreamStatistics of_one;
  StreamOptions stream;
  stream.statistics = &of_one;
  const RenderResult alone = render(blocks, options, stream);
  const auto errors = run_ranks(3, [&](const auto& ranks) {
    const std::unique_ptr<HitExchange> exchange = make_hit_exchange(*ranks);
    StreamStatistics of_all;
    StreamOptions part;
    part.part = ranks->rank();
    part.parts = ranks->size();
    part.exchange = exchange.get();
    part.statistics = &of_all;
    const RenderResult shared = render(blocks, options, part);
    EXPECT_EQ(differing(shared, alone), "");
    EXPECT_EQ(of_all.blocks, of_one.blocks);
    EXPECT_EQ(of_all.blocks, of_all.culled_blocks + of_all.hidden_blocks + of_all.read_blocks);
    std::uint64_t tests = 0;
    for (const BatchStatistics& batch : shared.statistics.batches) tests += batch.total_tests();
    std::vector<std::uint64_t> sum{tests};
    add(*ranks, sum);
    EXPECT_EQ(sum[0], 3 * tests) << "the counts of all are everyone's";
  });
  EXPECT_EQ(errors, kNoErrors);
}

std::vector<Ray> rays_into_cornell(std::size_t count) {
  Random random(7);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.origin = random.in_box(1);
    ray.direction = random.direction();
  }
  return rays;
}

TEST(Ranks, QueriesHaveTheSameBits) {
  const SceneDescription description = builtin_scene("cornell");
  const std::vector<Ray> rays = rays_into_cornell(30'000);
  const auto filled = [&](const Context& context) {
    Scene scene(context);
    for (const Mesh& mesh : description.meshes) scene.add(mesh.positions, mesh.triangles);
    scene.commit();
    return scene;
  };
  const Scene own = filled(Context({Device::kCpu, 1}));
  QueryStatistics alone;
  const std::vector<Hit> hits = closest_hit(own, rays, QueryOptions{.statistics = &alone});
  const std::vector<std::uint8_t> occluded = any_hit(own, rays);
  const auto errors = run_ranks(3, [&](const auto& ranks) {
    const Scene scene = filled(distributed({Device::kCpu, 1}, ranks));
    QueryStatistics statistics;
    QueryOptions options;
    options.count_tests = true;
    options.statistics = &statistics;
    const std::vector<Hit> shared = closest_hit(scene, rays, options);
    EXPECT_EQ(std::memcmp(shared.data(), hits.data(), hits.size() * sizeof(Hit)), 0);
    EXPECT_EQ(statistics.rays, rays.size());
    EXPECT_EQ(statistics.triangles, alone.triangles);
    EXPECT_GT(statistics.tests(), rays.size());
    EXPECT_EQ(any_hit(scene, rays), occluded);
    std::vector<Ray> wrong = rays;
    wrong[29'999].direction = {};
    static_cast<void>(closest_hit(scene, wrong));
  });
  for (const std::string& error : errors)
    EXPECT_NE(error.find("rays[29999]"), std::string::npos) << error;
}

/// The second of two processes, when the first took all the work.
class Idle : public Communicator {
 public:
  [[nodiscard]] std::uint32_t rank() const override { return 1; }
  [[nodiscard]] std::uint32_t size() const override { return 2; }
  void broadcast(std::span<std::byte> /*bytes*/) override {}
  void combine(std::span<std::byte> /*elements*/, std::size_t /*element_bytes*/,
               Combine /*how*/) override {}
  [[nodiscard]] std::optional<std::uint64_t> take(std::uint64_t /*items*/) override { return {}; }
  [[nodiscard]] Error fail(const Error& error) noexcept override { return error; }
};

TEST(Ranks, AnIdleRankReportsTheTriangles) {
  Scene scene(distributed({Device::kCpu, 1}, std::make_shared<Idle>()));
  const std::vector<Vec3> corners{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  scene.add_soup(corners, {.mask = 1});
  const MeshId mesh = scene.add_soup(corners, {.mask = 2});
  scene.instance(mesh, {}, 2);
  scene.commit();
  const std::vector<Ray> rays = rays_into_cornell(100'000);
  std::vector<Hit> hits(rays.size());
  for (const std::uint32_t mask : {0u, 1u, 2u, 3u, ~0u}) {
    QueryStatistics statistics;
    closest_hit(scene, rays, hits, {.mask = mask, .statistics = &statistics});
    EXPECT_EQ(statistics.rays, rays.size());
    EXPECT_EQ(statistics.triangles, mask == ~0u ? 3 : mask);
    EXPECT_GT(statistics.update_ms, 0);
  }
}

}  // namespace
}  // namespace raysheaf::test
