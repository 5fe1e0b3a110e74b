// `gl10` as a device does it: brute force's hits, and the CPU's counts, with lists of any capacity.
// On the CPU as a device; frames of it run on a CUDA device, too (tests/frame/device_test.cpp).
#include "engine/packet_tracer.h"

#include <gtest/gtest.h>

#include <numeric>

#include "intersect/brute_force.h"
#include "raysheaf/error.h"
#include "support/soups.h"
#include "tests/support/device_memory.h"

namespace raysheaf::test {
namespace {

/// A scene, its hierarchy, and rays that packets were cut from.
struct Packed {
  const Executor& executor;
  SceneDescription scene;
  FlatScene flat;
  Bvh bvh;
  std::vector<Vec3> corners;
  std::vector<Ray> rays;
  std::vector<Packet> packets;

  Packed(const Executor& e, SceneDescription description, std::uint32_t ray_count,
         std::uint32_t most_rays)
      : executor(e),
        scene(std::move(description)),
        flat(flatten(e, scene, mesh_bounds(e, scene))),
        bvh(build_bvh(e, flat.triangles())) {
    for (std::uint32_t i = 0; i < flat.triangle_count; ++i)
      for (int k = 0; k < 3; ++k) corners.push_back(flat.corner(i, k));
    const std::vector<Ray> given = rays_at(scene, ray_count, 5);
    std::vector<std::uint32_t> order(given.size());
    std::iota(order.begin(), order.end(), 0u);
    packets = make_packets(e, given, {}, 32, most_rays, order);
    for (const std::uint32_t ray : order) rays.push_back(given[ray]);
  }
  [[nodiscard]] PacketScene there() const {
    return {View<const Vec3>(corners),
            View<const std::uint8_t>(flat.flags.data(), flat.triangle_count), flat.bounds, bvh};
  }
};

void expect_as_cpu(PacketTracer& tracer, const Packed& p, const PacketOptions& options) {
  std::vector<RayHit> there(p.rays.size(), RayHit{-1, 7}), here(p.rays.size());
  const PacketCounts counts = tracer.trace(
      {View<const Ray>(p.rays), View<const Packet>(p.packets), options}, View<RayHit>(there));
  ProgressMeter meter;
  const PacketCounts expected =
      traverse_packets(p.executor, p.flat, p.bvh, p.packets, p.rays, options, here, {}, &meter);
  for (std::size_t i = 0; i < here.size(); ++i) {
    ASSERT_EQ(there[i].triangle, here[i].triangle) << "ray " << i;
    ASSERT_EQ(float_bits(there[i].t), float_bits(here[i].t)) << "ray " << i;
  }
  EXPECT_EQ(counts.tests, expected.tests);
  EXPECT_EQ(counts.hits, expected.hits);
  EXPECT_EQ(counts.final_tests, expected.final_tests);
  if (options.early_out) return;
  std::vector<RayHit> brute(p.rays.size());
  intersect_brute_force(p.executor, p.flat.triangles(), p.rays, options.facing, brute, &meter);
  for (std::size_t i = 0; i < brute.size(); ++i) {
    ASSERT_EQ(there[i].triangle, brute[i].triangle) << "ray " << i;
    ASSERT_EQ(float_bits(there[i].t), float_bits(brute[i].t)) << "ray " << i;
  }
}

struct PacketEmulation {
  Executor executor{2};
  HostAllocator heap;
  FailingAllocator memory{heap};

  std::unique_ptr<PacketTracer> tracer(std::uint32_t capacity) {
    return make_emulated_packet_tracer(capacity, executor, heap, &memory);
  }
};

TEST(PacketTracer, FindsTheHitsAndCountsAsTheCpu) {
  PacketEmulation emulation;
  for (const SoupKind kind : soup_kinds()) {
    for (const std::uint32_t most_rays : {1u, 16u, 256u}) {
      const Packed packed(emulation.executor, soup(kind, 400, 21), 900, most_rays);
      for (const std::uint32_t capacity : {1u, 1000u, kPairCapacity}) {
        SCOPED_TRACE(std::to_string(most_rays) + " " + std::to_string(capacity));
        const std::unique_ptr<PacketTracer> tracer = emulation.tracer(capacity);
        tracer->set_scene(packed.there());
        PacketOptions options;
        expect_as_cpu(*tracer, packed, options);
        options.facing = Facing::kSkipBackOfSingleSided;
        options.early_out = true;
        expect_as_cpu(*tracer, packed, options);
      }
    }
  }
  EXPECT_EQ(emulation.memory.alive(), 0u);
}

TEST(PacketTracer, FewRaysFewTrianglesAndNone) {
  PacketEmulation emulation;
  const std::unique_ptr<PacketTracer> tracer = emulation.tracer(100);
  for (const std::uint32_t rays : {0u, 1u, 2u, 257u}) {
    for (const std::uint32_t triangles : {1u, 9u}) {
      const Packed packed(emulation.executor, soup(soup_kinds().front(), triangles, 3), rays, 256);
      tracer->set_scene(packed.there());
      expect_as_cpu(*tracer, packed, {});
    }
  }
  const Packed packed(emulation.executor, soup(soup_kinds().front(), 1, 3), 9, 256);
  const Bvh none;
  tracer->set_scene({{}, {}, {}, none});
  std::vector<RayHit> hits(9, RayHit{0, 1});
  static_cast<void>(tracer->trace(
      {View<const Ray>(packed.rays), View<const Packet>(packed.packets), {}}, View<RayHit>(hits)));
  for (const RayHit& hit : hits) EXPECT_FALSE(hit.found());
}

TEST(PacketTracer, MemoryThatRunsOutAnywhereLeavesItUsable) {
  PacketEmulation emulation;
  const Packed packed(emulation.executor, soup(soup_kinds().front(), 60, 3), 70, 16);
  std::uint64_t allowed = 0;
  for (bool failed = true; failed; ++allowed) {
    const std::unique_ptr<PacketTracer> tracer = emulation.tracer(64);
    failed = false;
    emulation.memory.let(allowed);
    try {
      tracer->set_scene(packed.there());
      expect_as_cpu(*tracer, packed, {});
    } catch (const Error& error) {
      failed = true;
      EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory);
      EXPECT_NE(error.place().find(": "), std::string::npos) << "a stage: " << error.place();
    }
    emulation.memory.let(FailingAllocator::kAlways);
    tracer->set_scene(packed.there());
    expect_as_cpu(*tracer, packed, {});
  }
  EXPECT_GT(allowed, 20u);
  EXPECT_EQ(emulation.memory.alive(), 0u);
}

}  // namespace
}  // namespace raysheaf::test
