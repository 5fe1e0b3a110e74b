// Streaming on a device with little memory, which only an emulated device can have.
#include <gtest/gtest.h>

#include <cstring>

#include "base/vec.h"
#include "emulated/open_emulated.h"
#include "out_of_core/block_tracer.h"
#include "out_of_core/stream_support.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "support/guarded_memory.h"
#include "support/soups.h"

namespace raysheaf::test {
namespace {

TEST(StreamOnLittleDevices, RaysThatDoNotFitComeInParts) {
  const SceneDescription office = builtin_scene("office");
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(office, &blocks, 100));
  const std::vector<Ray> rays = rays_at(office, 9000, 6);
  const Said expected(blocks, rays, {});
  const EmulatedMachine small(std::uint64_t{7} << 19);
  StreamStatistics statistics;
  StreamOptions options;
  options.context = &small.context;
  options.statistics = &statistics;
  EXPECT_TRUE(Said(blocks, rays, options) == expected);
  EXPECT_GT(statistics.blocks, 2 * blocks.blocks().size());
  EXPECT_EQ(small.memory.alive(), 0u);
}

TEST(StreamOnLittleDevices, TooLargeBlocksAreReported) {
  const SceneDescription office = builtin_scene("office");
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(office, &blocks));
  const EmulatedMachine small(std::uint64_t{1} << 20);
  StreamOptions options;
  options.context = &small.context;
  try {
    static_cast<void>(Said(blocks, rays_at(office, 10, 6), options));
    FAIL() << "there was room";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory);
    EXPECT_EQ(error.place(), "the device's memory");
    EXPECT_NE(error.sentence().find("MiB"), std::string::npos) << error.what();
  }
}

TEST(StreamOnLittleDevices, RunningOutOfMemoryAtAnyTimeIsReported) {
  const SceneDescription office = builtin_scene("office");
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(office, &blocks, 1500));
  const std::vector<Ray> rays = rays_at(office, 300, 7);
  const Said expected(blocks, rays, {});
  EmulatedMachine machine;
  StreamOptions options;
  options.context = &machine.context;
  static_cast<void>(Said(blocks, rays, options));
  const std::uint64_t needed = machine.memory.made();
  for (std::uint64_t allocations = 0; allocations < needed; ++allocations) {
    machine.memory.let(allocations);
    try {
      static_cast<void>(Said(blocks, rays, options));
      FAIL() << "there was memory: " << allocations;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory) << error.what();
    }
    EXPECT_EQ(machine.memory.alive(), 0u) << allocations;
  }
  machine.memory.let(FailingAllocator::kAlways);
  EXPECT_TRUE(Said(blocks, rays, options) == expected);
}

/// More blocks than the two buffers.
TEST(StreamOnLittleDevices, MoreBlocksThanBuffers) {
  const SceneDescription office = builtin_scene("office");
  BlockList blocks;
  blocks.set_scene(cut_into_blocks(office, &blocks, 100));
  const std::vector<Ray> rays = rays_at(office, 1000, 8);
  const Executor executor(2);
  test::GuardedMemory heap;
  for (const std::uint32_t buffers : {2u, 3u, 16u}) {
    BlockLimits limits;
    limits.memory_bytes = std::uint64_t{1} << 30;
    limits.most_buffers = buffers;
    const auto tracer = open_emulated(executor, heap)->make_block_tracer(executor, limits);
    std::vector<StreamHit> hits(rays.size());
    BlockBatch batch;
    batch.rays = View<const Ray>(rays);
    batch.hits = View<StreamHit>(hits);
    std::vector<Box> boxes;
    for (const BlockInfo& info : blocks.blocks()) {
      boxes.push_back(info.bounds);
      batch.scene.min = min(batch.scene.min, info.bounds.min);
      batch.scene.max = max(batch.scene.max, info.bounds.max);
    }
    tracer->begin(batch);
    std::vector<float> distances(boxes.size());
    tracer->find_distances(View<const Box>(boxes), View<float>(distances));
    std::vector<TriangleBlock> all(boxes.size());
    std::vector<TracedBlock> round;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      blocks.read(i, &all[i]);
      round.push_back({i, &all[i]});
      if (round.size() < 7 && i + 1 < boxes.size()) continue;
      tracer->load(View<const TracedBlock>(round));
      tracer->trace();
      round.clear();
    }
    const BlockReport report = tracer->finish();
    EXPECT_GT(report.triangle_tests, 0u);
    std::vector<Hit> expected(rays.size());
    closest_hit(blocks, rays, expected);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_EQ(std::memcmp(&hits[i].hit, &expected[i], sizeof(Hit)), 0) << i;
  }
}

}  // namespace
}  // namespace raysheaf::test
