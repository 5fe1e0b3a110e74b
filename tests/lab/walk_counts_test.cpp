// How rays traverse the device's object tree, counted per warp.
#include "lab/walk_counts.h"
#include "emulated/open_emulated.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "device/device_queries.h"
#include "raysheaf/builtin_scenes.h"
#include "support/random.h"

namespace raysheaf {
namespace {

TEST(WalkCounts, AWarpTurnsAsOftenAsItsBusiestThread) {
  EXPECT_EQ(warp_turns({}), 0u);
  std::vector<std::uint32_t> turns(70, 1);
  EXPECT_EQ(warp_turns(turns), 3u) << "the last warp has six threads";
  turns[31] = 5;
  turns[32] = 7;
  turns[40] = 6;
  EXPECT_EQ(warp_turns(turns), 5u + 7u + 1u);
}

/// Corners of triangles in a cube of side 10, and rays row by row from below it.
std::vector<Vec3> small_triangles(std::size_t count) {
  test::Random random(3);
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 center = random.in_box(5);
    for (int k = 0; k < 3; ++k) corners.push_back(center + random.in_box(0.5f));
  }
  return corners;
}
std::vector<Ray> upward_rays(std::size_t side) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < side * side; ++i) {
    const auto x = static_cast<float>(i % side), y = static_cast<float>(i / side);
    const float step = 10 / static_cast<float>(side);
    rays.push_back({{x * step - 5, y * step - 5, -10}, 0, {0, 0, 1}, 100});
  }
  return rays;
}

struct Emulation {
  explicit Emulation(std::uint32_t threads) : executor(threads) {}
  Executor executor;
  HostAllocator memory;
  EmulatedDevice device{executor, memory};
};

TEST(WalkCounts, OneLeafHasNoNodes) {
  Emulation emulation(1);
  const std::vector<Vec3> corners = small_triangles(3);
  const std::vector<Ray> rays = upward_rays(10);
  const DeviceWalks walks = count_walks_on(emulation.device, {corners, {}}, rays, false);
  EXPECT_EQ(walks.count, 100u);
  EXPECT_EQ(walks.nodes, 0u);
  EXPECT_EQ(walks.leaves, 100u);
  EXPECT_EQ(walks.triangles, 300u);
  EXPECT_EQ(walks.warps(), 4u);
  EXPECT_EQ(walks.warp_turns, 4u);
  EXPECT_EQ(walks.sorted_warp_turns, 4u);
}

TEST(WalkCounts, WithoutRaysAllIsZero) {
  Emulation emulation(1);
  const DeviceWalks walks = count_walks_on(emulation.device, {}, {}, true);
  EXPECT_EQ(walks.count, 0u);
  EXPECT_EQ(walks.nodes + walks.leaves + walks.triangles + walks.warp_turns, 0u);
}

TEST(WalkCounts, TestsAreThoseOfTheDevicesQueries) {
  const Executor executor(2);
  HostAllocator memory;
  const std::unique_ptr<DeviceQueries> engine = open_emulated(executor, memory)->make_queries();
  const std::vector<Vec3> corners = small_triangles(2000);
  const std::vector<Ray> rays = upward_rays(70);
  const TriangleRun run{corners.data(), nullptr, 0, 2000};
  engine->set_triangles(executor, {{&run, 1}, 2000}, false);
  for (const bool any : {false, true}) {
    QueryReport report;
    DeviceQuery query;
    query.count = true;
    query.report = &report;
    std::vector<IndexedHit> closest(rays.size());
    std::vector<std::uint8_t> occluded(rays.size());
    any ? engine->any_hit(rays, query, View<std::uint8_t>(occluded))
        : engine->closest_hit(rays, query, View<IndexedHit>(closest));
    const auto hits =
        any ? std::count(occluded.begin(), occluded.end(), 1)
            : std::count_if(closest.begin(), closest.end(),
                            [](const IndexedHit& hit) { return hit.triangle != kInvalidId; });
    Emulation emulation(2);
    const DeviceWalks walks = count_walks_on(emulation.device, {corners, {}}, rays, any);
    EXPECT_EQ(2 * walks.nodes, report.ray_bound_tests);
    EXPECT_EQ(walks.triangles, report.triangle_tests);
    EXPECT_EQ(walks.hits, static_cast<std::uint64_t>(hits));
    EXPECT_GT(walks.leaves, 0u);
    EXPECT_GE(walks.warp_turns * kWarpThreads, walks.nodes + walks.leaves);
    EXPECT_GE(walks.sorted_warp_turns * kWarpThreads, walks.nodes + walks.leaves);
  }
}

TEST(WalkCounts, SortingHelpsShuffledRaysAndThreadsChangeNothing) {
  const std::vector<Vec3> corners = small_triangles(2000);
  std::vector<Ray> rays = upward_rays(70);
  test::Random random(7);
  for (std::size_t i = rays.size(); i > 1; --i)
    std::swap(rays[i - 1], rays[random.below(static_cast<std::uint32_t>(i))]);
  Emulation one(1), three(3);
  const DeviceWalks a = count_walks_on(one.device, {corners, {}}, rays, false);
  const DeviceWalks b = count_walks_on(three.device, {corners, {}}, rays, false);
  EXPECT_LT(a.sorted_warp_turns, a.warp_turns);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.leaves, b.leaves);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.warp_turns, b.warp_turns);
  EXPECT_EQ(a.sorted_warp_turns, b.sorted_warp_turns);
}

TEST(WalkCounts, AllKindsOfABuiltinScene) {
  DeviceBenchOptions options;
  options.width = options.height = 40;
  const SceneDescription scene = builtin_scene("cornell");
  const DeviceWalksReport report = count_device_walks(scene, options);
  EXPECT_GT(report.triangles, 0u);
  ASSERT_EQ(report.batches.size(), 4u);
  for (const DeviceWalks& walks : report.batches) {
    EXPECT_GT(walks.count, 0u);
    EXPECT_GT(walks.hits, 0u);
    EXPECT_GE(walks.nodes + walks.count, walks.leaves) << "of n leaves, below n - 1 nodes";
    EXPECT_GE(walks.triangles, walks.leaves);
  }
  options.rays = {LabRays::kAmbientOcclusion};
  const DeviceWalksReport one = count_device_walks(scene, options);
  ASSERT_EQ(one.batches.size(), 1u);
  EXPECT_EQ(one.batches[0].rays, LabRays::kAmbientOcclusion);
  EXPECT_EQ(one.batches[0].nodes, report.batches[3].nodes) << "the same numbers again";
}

}  // namespace
}  // namespace raysheaf
