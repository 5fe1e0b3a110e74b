// `gl10` on a device: brute force's hits and the CPU's counts, with packets of any size and lists
// of any capacity.
#include "paper/packets/packet_tracer_device.h"

#include "emulated/emulated_device.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "paper/base/flat_arrays.h"
#include "paper/order/order.h"
#include "raysheaf/error.h"
#include "render/frame/brute_force.h"
#include "support/soups.h"
#include "tests/device/same_counts.h"
#include "tests/support/device_memory.h"
#include "tests/support/guarded_memory.h"

namespace raysheaf::test {
namespace {

/// A scene, its hierarchy, and rays with keys.
struct Packed {
  const Executor& executor;
  SceneDescription scene;
  FlatScene flat;
  FlatArrays arrays;
  Bvh bvh;
  std::vector<Vec3> corners;
  std::vector<Ray> rays;
  std::vector<std::uint32_t> keys;

  /// `values` is the number of different keys, in runs; 0: no keys.
  Packed(const Executor& e, SceneDescription description, std::uint32_t ray_count,
         std::uint32_t values)
      : executor(e),
        scene(std::move(description)),
        flat(flatten(e, scene, mesh_bounds(e, scene))),
        arrays(e, flat),
        bvh(build_bvh(e, arrays.view())),
        rays(rays_at(scene, ray_count, 5)) {
    for (std::uint32_t i = 0; i < flat.triangle_count; ++i)
      for (int k = 0; k < 3; ++k) corners.push_back(arrays.view().corner(i, k));
    std::mt19937 random(values);
    while (values != 0 && keys.size() < rays.size()) {
      const auto key = static_cast<std::uint32_t>(random() % values) * (0xffffffffu / values);
      keys.insert(keys.end(), std::min<std::size_t>(1 + random() % 3, rays.size() - keys.size()),
                  key);
    }
  }
  void give_to(DeviceBatchTracer* tracer) const {
    tracer->set_scene(executor, flat,
                      {View<const Vec3>(corners),
                       View<const std::uint8_t>(flat.flags.data(), flat.triangle_count)});
  }
};

/// How a packet tracer is asked.
struct Ask {
  std::uint32_t most_rays = kPacketRays;  ///< of a packet
  std::uint32_t key_bits = 32;
  BatchOptions options;
};

/// Runs the CPU's stages on the same rays; hits are stored by ray.
BatchStatistics trace_here(const Packed& p, const Ask& ask, std::vector<RayHit>* hits) {
  BatchStatistics statistics;
  std::vector<std::uint32_t> order(p.rays.size()), sorted_keys;
  std::iota(order.begin(), order.end(), 0u);
  if (!p.keys.empty())
    statistics.chunks = order_by_key(p.executor, p.keys, View<std::uint32_t>(order), ask.key_bits);
  if (!p.keys.empty())
    for (const std::uint32_t ray : order) sorted_keys.push_back(p.keys[ray]);
  const std::vector<Packet> packets =
      make_packets(p.executor, p.rays, sorted_keys, ask.key_bits, ask.most_rays, order);
  std::vector<Ray> rays;
  for (const std::uint32_t ray : order) rays.push_back(p.rays[ray]);
  PacketOptions options;
  options.early_out = ask.options.early_out;
  options.facing = ask.options.facing;
  std::vector<RayHit> best(rays.size());
  ProgressMeter meter;
  traverse_packets(p.executor, p.arrays.view(), p.bvh, packets, rays, options, best, {}, &meter)
      .add_to(&statistics);
  hits->resize(rays.size());
  for (std::size_t i = 0; i < order.size(); ++i) (*hits)[order[i]] = best[i];
  return statistics;
}

void expect_as_cpu(DeviceBatchTracer& tracer, const Packed& p, const Ask& ask) {
  std::vector<IndexedHit> there(p.rays.size(), IndexedHit{-1, -1, -1, 7});
  BatchStatistics counts;
  tracer.trace(View<const Ray>(p.rays), View<const std::uint32_t>(p.keys), ask.key_bits,
               ask.options, View<IndexedHit>(there), &counts, nullptr);
  std::vector<RayHit> here, brute(p.rays.size());
  const BatchStatistics expected = trace_here(p, ask, &here);
  for (std::size_t i = 0; i < here.size(); ++i) {
    ASSERT_EQ(there[i].triangle, here[i].triangle) << "ray " << i;
    ASSERT_EQ(float_bits(there[i].t), float_bits(here[i].t)) << "ray " << i;
  }
  expect_same_counts(counts, expected);
  if (ask.options.early_out) return;
  ProgressMeter meter;
  intersect_brute_force(p.executor, p.flat.source(), p.rays, ask.options.facing, brute, &meter);
  for (std::size_t i = 0; i < brute.size(); ++i) {
    ASSERT_EQ(there[i].triangle, brute[i].triangle) << "ray " << i;
    ASSERT_EQ(float_bits(there[i].t), float_bits(brute[i].t)) << "ray " << i;
  }
}

struct PacketEmulation {
  Executor executor{2};
  test::GuardedMemory heap;
  FailingAllocator memory{heap};

  std::unique_ptr<DeviceBatchTracer> tracer(std::uint32_t capacity, std::uint32_t most_rays) {
    return std::make_unique<PacketTracerOn<EmulatedDevice>>(capacity, most_rays, executor, heap,
                                                            &memory);
  }
};

TEST(PacketTracer, FindsTheHitsAndCountsAsTheCpu) {
  PacketEmulation emulation;
  for (const SoupKind kind : soup_kinds()) {
    for (const std::uint32_t values : {0u, 1u, 300u, 1u << 20}) {
      for (const std::uint32_t capacity : {1u, 1000u, kPairCapacity}) {
        // With a small capacity, every pass processes few pairs.
        const bool few = capacity == 1;
        const Packed packed(emulation.executor, soup(kind, few ? 20 : 100, 21), few ? 30 : 200,
                            values);
        SCOPED_TRACE(std::to_string(values) + " keys, capacity " + std::to_string(capacity));
        for (const bool early : {false, true}) {
          Ask ask;
          ask.most_rays = few ? (early ? 1 : 16) : (early ? 7 : 256);
          if (early) ask.options.facing = Facing::kSkipBackOfSingleSided;
          ask.options.early_out = early;
          const std::unique_ptr<DeviceBatchTracer> tracer =
              emulation.tracer(capacity, ask.most_rays);
          packed.give_to(tracer.get());
          expect_as_cpu(*tracer, packed, ask);
        }
      }
    }
  }
  EXPECT_EQ(emulation.memory.alive(), 0u);
}

TEST(PacketTracer, KeysOfFewBits) {
  PacketEmulation emulation;
  Packed packed(emulation.executor, soup(soup_kinds().front(), 100, 3), 700, 64);
  const Ask ask{5, 6, {}};  // fewer rays than share a key
  const std::unique_ptr<DeviceBatchTracer> tracer = emulation.tracer(1000, ask.most_rays);
  packed.give_to(tracer.get());
  for (std::uint32_t& key : packed.keys) key >>= 26;
  expect_as_cpu(*tracer, packed, ask);
}

TEST(PacketTracer, FewRaysFewTrianglesAndNone) {
  PacketEmulation emulation;
  const std::unique_ptr<DeviceBatchTracer> tracer = emulation.tracer(100, kPacketRays);
  for (const std::uint32_t rays : {0u, 1u, 2u, 257u}) {
    for (const std::uint32_t triangles : {1u, 9u}) {
      const Packed packed(emulation.executor, soup(soup_kinds().front(), triangles, 3), rays, 3);
      packed.give_to(tracer.get());
      expect_as_cpu(*tracer, packed, {});
    }
  }
  const Packed packed(emulation.executor, soup(soup_kinds().front(), 1, 3), 9, 3);
  tracer->set_scene(emulation.executor, {}, {});
  std::vector<IndexedHit> hits(9, IndexedHit{0, 0, 0, 1});
  BatchStatistics counts;
  tracer->trace(View<const Ray>(packed.rays), View<const std::uint32_t>(packed.keys), 32, {},
                View<IndexedHit>(hits), &counts, nullptr);
  for (const IndexedHit& hit : hits) EXPECT_EQ(hit.triangle, kInvalidId);
}

TEST(PacketTracer, MemoryThatRunsOutAnywhereLeavesItUsable) {
  PacketEmulation emulation;
  const Packed packed(emulation.executor, soup(soup_kinds().front(), 60, 3), 70, 30);
  const Ask ask{16, 32, {}};
  std::uint64_t allowed = 0;
  for (bool failed = true; failed; ++allowed) {
    const std::unique_ptr<DeviceBatchTracer> tracer = emulation.tracer(64, ask.most_rays);
    failed = false;
    emulation.memory.let(allowed);
    try {
      packed.give_to(tracer.get());
      expect_as_cpu(*tracer, packed, ask);
    } catch (const Error& error) {
      failed = true;
      EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory);
      EXPECT_NE(error.place().find(": "), std::string::npos) << "a stage: " << error.place();
    }
    emulation.memory.let(FailingAllocator::kAlways);
    packed.give_to(tracer.get());
    expect_as_cpu(*tracer, packed, ask);
  }
  EXPECT_GT(allowed, 20u);
  EXPECT_EQ(emulation.memory.alive(), 0u);
}

}  // namespace
}  // namespace raysheaf::test
