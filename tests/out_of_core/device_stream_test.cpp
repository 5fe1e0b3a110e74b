// Streaming blocks on a device gives the CPU's answers bit for bit: on an emulated device, and on a
// CUDA device if the machine has one.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <numeric>

#include "base/vec.h"
#include "out_of_core/stream_support.h"
#include "raysheaf/block_file.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/query.h"
#include "raysheaf/render.h"
#include "raysheaf/stream.h"
#include "support/random.h"
#include "support/soups.h"
#include "tests/support/process.h"

namespace raysheaf::test {
namespace {

/// Runs on each device that this machine has.
class StreamOnDevice : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    if (!GetParam()) {
      context_ = &emulated_.context;
      return;
    }
    try {
      cuda_ = std::make_unique<Context>(ContextOptions{.device = Device::kCuda});
      context_ = cuda_.get();
    } catch (const Error& error) {
      if (error.code() != ErrorCode::kUnsupported) throw;
      GTEST_SKIP() << error.what();
    }
  }
  [[nodiscard]] StreamOptions there() const {
    StreamOptions options;
    options.context = context_;
    return options;
  }

  EmulatedMachine emulated_;
  std::unique_ptr<Context> cuda_;
  const Context* context_ = nullptr;
};

/// A scene's blocks in random order; each of their triangles belongs to two instances.
struct ShuffledScene {
  SceneDescription scene;
  BlockList blocks;

  ShuffledScene(SoupKind kind, std::uint32_t size, std::uint32_t triangles_a_block,
                std::uint64_t seed)
      : scene(soup(kind, size, seed)) {
    const std::vector<Instance> once = scene.instances;
    scene.instances.insert(scene.instances.end(), once.begin(), once.end());
    BlockList ordered;
    blocks.set_scene(cut_into_blocks(scene, &ordered, triangles_a_block));
    std::vector<std::size_t> order(ordered.blocks().size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    Random random(seed + 1);
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
    TriangleBlock block;
    BlockShading shading;
    for (const std::size_t i : order) {
      ordered.read(i, &block);
      ordered.read_shading(i, &shading);
      blocks.add(block, shading);
    }
  }
};

std::vector<Hit> by_brute_force(const SceneDescription& scene, const std::vector<Ray>& rays) {
  QueryOptions options;
  options.method = QueryMethod::kBrute;
  return closest_hit(resident(scene), rays, options);
}

TEST_P(StreamOnDevice, AnswersAreThoseOfTheCpuAndOfBruteForce) {
  for (const SoupKind kind : soup_kinds()) {
    for (const std::uint32_t size : {1u, 150u}) {
      const std::uint32_t most = size == 1 ? 1 : 3 + 20 * (static_cast<std::uint32_t>(kind) % 2);
      SCOPED_TRACE(testing::Message() << "kind " << static_cast<int>(kind) << ", " << size);
      const ShuffledScene shuffled(kind, size, most, size + 3);
      const std::vector<Ray> rays = rays_at(shuffled.scene, 500, size + 5);
      StreamOptions options = there();
      options.front_to_back = static_cast<int>(kind) % 3 != 0;
      const Said said(shuffled.blocks, rays, options);
      EXPECT_TRUE(said == Said(shuffled.blocks, rays, {}));
      const std::vector<Hit> expected = by_brute_force(shuffled.scene, rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(std::memcmp(&said.hits[i], &expected[i], sizeof(Hit)), 0) << i;
        ASSERT_EQ(said.occluded[i], expected[i].prim_id != kInvalidId ? 1 : 0) << i;
      }
    }
  }
}

TEST_P(StreamOnDevice, ManyRaysManyBlocksAndFew) {
  const SceneDescription hall = hall_scene(20000, 1);
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(hall, &blocks, 300));
  for (const std::uint32_t count : {0u, 1u, 15u, 16u, 17u, 257u, 5000u}) {
    SCOPED_TRACE(count);
    const std::vector<Ray> rays = count > 0 ? rays_at(hall, count, 9) : std::vector<Ray>();
    StreamStatistics statistics, expected;
    StreamOptions options = there(), here;
    options.statistics = &statistics;
    here.statistics = &expected;
    options.memory_bytes = here.memory_bytes = 96u << 20;
    EXPECT_TRUE(Said(blocks, rays, options) == Said(blocks, rays, here));
    EXPECT_EQ(statistics.blocks, expected.blocks);
    EXPECT_EQ(statistics.blocks,
              statistics.culled_blocks + statistics.hidden_blocks + statistics.read_blocks);
    // The culling uses the same bounds, but of trees that are rebuilt at other times.
    EXPECT_NEAR(static_cast<double>(statistics.read_blocks),
                static_cast<double>(expected.read_blocks),
                4 + 0.1 * static_cast<double>(expected.read_blocks));
    const std::uint64_t read = statistics.read_bytes, wasted = statistics.wasted_blocks;
    statistics = {};
    static_cast<void>(Said(blocks, rays, options));
    EXPECT_EQ(statistics.read_bytes, read);
    EXPECT_EQ(statistics.wasted_blocks, wasted);
  }
}

TEST_P(StreamOnDevice, WithoutBlocksAndFarAway) {
  const BlockList none;
  std::vector<Ray> rays = rays_at(soup(SoupKind::kSmall, 5, 1), 40, 1);
  const Said said(none, rays, there());
  EXPECT_EQ(said.hits[0].prim_id, kInvalidId);
  EXPECT_EQ(said.occluded, std::vector<std::uint8_t>(rays.size(), 0));
  // So far away that squared distances overflow.
  BlockList one;
  one.set_scene(cut_into_blocks(soup(SoupKind::kLarge, 30, 2), &one, 8));
  for (Ray& ray : rays) {
    ray.direction = ray.direction * 1e22f;
    ray.origin = ray.origin - ray.direction;
  }
  StreamStatistics here, there_too;
  StreamOptions options = there(), on_cpu;
  options.statistics = &there_too;
  on_cpu.statistics = &here;
  EXPECT_TRUE(Said(one, rays, options) == Said(one, rays, on_cpu));
  EXPECT_EQ(there_too.culled_blocks, here.culled_blocks);
  EXPECT_LT(here.culled_blocks, here.blocks);
}

TEST_P(StreamOnDevice, FramesAreThoseOfTheCpu) {
  SceneDescription scene = builtin_scene("cornell");
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(scene, &blocks, 50));
  RenderOptions options;
  options.width = 60;
  options.height = 40;
  options.primary = Primary::kTrace;
  options.count_pixel_tests = true;
  const RenderResult here = render(blocks, options);
  StreamStatistics statistics;
  StreamOptions stream = there();
  stream.statistics = &statistics;
  const RenderResult result = render(blocks, options, stream);
  EXPECT_EQ(std::memcmp(result.beauty.data(), here.beauty.data(),
                        here.beauty.size() * sizeof here.beauty[0]),
            0);
  EXPECT_EQ(result.shadow, here.shadow);
  EXPECT_EQ(result.statistics.device, "cuda");
  EXPECT_GT(statistics.trace_ms + statistics.cull_ms, 0);
  ASSERT_EQ(result.statistics.batches.size(), here.statistics.batches.size());
  double tests = 0;
  for (const float pixel : result.tests) tests += pixel;
  double counted = 0;
  for (const BatchStatistics& batch : result.statistics.batches) {
    counted += static_cast<double>(batch.ray_bound_tests + batch.final_tests);
    EXPECT_NE(batch.plan.front().find("device:"), std::string::npos);
  }
  EXPECT_GT(counted, 0);
  EXPECT_NEAR(tests, counted, 1e-3 * counted);
}

TEST_P(StreamOnDevice, GoesOnWhereItWasStopped) {
  const SceneDescription office = builtin_scene("office");
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(office, &blocks, 60));
  const std::vector<Ray> rays = rays_at(office, 1500, 3);
  const Said expected(blocks, rays, {});
  for (const bool any : {false, true}) {
    const TemporaryFolder folder;
    std::uint64_t read_before = 0;
    for (const bool again : {false, true}) {
      CheckpointFile file(folder.file("kept"), "office", 0);
      StreamStatistics statistics;
      StreamOptions options = there();
      options.memory_bytes = 96u << 20;
      options.checkpoint = &file;
      options.statistics = &statistics;
      int calls = again ? -1 : 6;
      options.progress = [&calls](const Progress&) { return calls-- != 0; };
      std::vector<Hit> hits(rays.size());
      std::vector<std::uint8_t> occluded(rays.size());
      try {
        any ? any_hit(blocks, rays, occluded, options) : closest_hit(blocks, rays, hits, options);
        EXPECT_TRUE(again);
        EXPECT_TRUE(
            any ? occluded == expected.occluded
                : std::memcmp(hits.data(), expected.hits.data(), hits.size() * sizeof(Hit)) == 0);
        EXPECT_LT(statistics.read_blocks, statistics.blocks);
        read_before = statistics.read_bytes;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kCancelled) << error.what();
        EXPECT_FALSE(again);
      }
    }
    StreamStatistics whole;
    StreamOptions options = there();
    options.statistics = &whole;
    static_cast<void>(Said(blocks, rays, options));
    EXPECT_LT(read_before, whole.read_bytes);
  }
}

TEST_P(StreamOnDevice, PartsOfTheBlocksCombineWithThoseOfTheCpu) {
  const SceneDescription scene = builtin_scene("cornell");
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(scene, &blocks, 40));
  const std::vector<Ray> rays = rays_at(scene, 1500, 5);
  Gathered all;
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  for (std::uint32_t part = 0; part < 3; ++part) {
    StreamOptions options = part == 1 ? StreamOptions() : there();
    options.part = part;
    options.parts = 3;
    options.exchange = &all;
    closest_hit(blocks, rays, hits, options);
    any_hit(blocks, rays, occluded, options);
  }
  const Said expected(blocks, rays, {});
  EXPECT_EQ(std::memcmp(hits.data(), expected.hits.data(), hits.size() * sizeof(Hit)), 0);
  EXPECT_EQ(occluded, expected.occluded);
}

/// Fails when the n-th block is read, or returns it without its last corners.
class Broken : public GeometrySource {
 public:
  Broken(const GeometrySource& of, int good, bool cut) : of_(of), good_(good), cut_(cut) {}
  [[nodiscard]] std::span<const BlockInfo> blocks() const override { return of_.blocks(); }
  void read(std::size_t block, TriangleBlock* out) const override {
    of_.read(block, out);
    if (good_-- > 0) return;
    if (!cut_) throw Error(ErrorCode::kIo, "the disk is gone", place(block));
    out->positions.pop_back();
  }
  void read_shading(std::size_t block, BlockShading* out) const override {
    of_.read_shading(block, out);
  }
  [[nodiscard]] const SceneDescription& scene() const override { return of_.scene(); }

 private:
  const GeometrySource& of_;
  mutable std::atomic<int> good_;
  bool cut_;
};

TEST_P(StreamOnDevice, BlocksThatFailEndItAndLeaveTheDeviceWhole) {
  const SceneDescription office = builtin_scene("office");
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(office, &blocks, 100));
  const std::vector<Ray> rays = rays_at(office, 800, 4);
  std::vector<Hit> hits(rays.size());
  StreamOptions options = there();
  options.memory_bytes = 96u << 20;
  for (const int good : {0, 1, 5, 17}) {
    for (const bool cut : {false, true}) {
      const Broken broken(blocks, good, cut);
      try {
        closest_hit(broken, rays, hits, options);
        FAIL() << "nothing failed";
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), cut ? ErrorCode::kInvalidData : ErrorCode::kIo);
        EXPECT_EQ(error.place().rfind("block ", 0), 0u) << error.what();
      }
      EXPECT_EQ(emulated_.memory.alive(), 0u);
    }
  }
  EXPECT_TRUE(Said(blocks, rays, options) == Said(blocks, rays, {}));
}

std::string stream_device_name(const testing::TestParamInfo<bool>& info) {
  return info.param ? "Cuda" : "Emulated";
}

INSTANTIATE_TEST_SUITE_P(Devices, StreamOnDevice, testing::Bool(), stream_device_name);

}  // namespace
}  // namespace raysheaf::test
