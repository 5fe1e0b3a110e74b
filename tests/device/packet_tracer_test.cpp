// `gl10` on a device: brute force's hits and the CPU's counts, with packets of any size and lists
// of any capacity.
#include "methods/packets/packet_tracer.h"
#include "emulated/open_emulated.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "intersect/brute_force.h"
#include "rays/order/order.h"
#include "raysheaf/error.h"
#include "scene/flat_arrays.h"
#include "support/soups.h"
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
  [[nodiscard]] PacketScene there() const {
    return {{View<const Vec3>(corners),
             View<const std::uint8_t>(flat.flags.data(), flat.triangle_count)},
            flat.bounds};
  }
};

/// Runs the CPU's stages on the same rays; hits are stored by ray.
PacketOutcome trace_here(const Packed& p, const PacketQuery& query, std::vector<RayHit>* hits) {
  PacketOutcome outcome;
  std::vector<std::uint32_t> order(p.rays.size()), sorted_keys;
  std::iota(order.begin(), order.end(), 0u);
  if (!p.keys.empty())
    outcome.chunks = order_by_key(p.executor, p.keys, View<std::uint32_t>(order), query.key_bits);
  if (!p.keys.empty())
    for (const std::uint32_t ray : order) sorted_keys.push_back(p.keys[ray]);
  const std::vector<Packet> packets =
      make_packets(p.executor, p.rays, sorted_keys, query.key_bits, query.most_rays, order);
  std::vector<Ray> rays;
  for (const std::uint32_t ray : order) rays.push_back(p.rays[ray]);
  PacketOptions options;
  options.early_out = query.early_out;
  options.facing = query.facing;
  std::vector<RayHit> best(rays.size());
  ProgressMeter meter;
  outcome.counts = traverse_packets(p.executor, p.arrays.view(), p.bvh, packets, rays, options,
                                    best, {}, &meter);
  hits->resize(rays.size());
  for (std::size_t i = 0; i < order.size(); ++i) (*hits)[order[i]] = best[i];
  return outcome;
}

void expect_as_cpu(PacketTracer& tracer, const Packed& p, const PacketQuery& query) {
  std::vector<IndexedHit> there(p.rays.size(), IndexedHit{-1, -1, -1, 7});
  const PacketOutcome outcome = tracer.trace(
      View<const Ray>(p.rays), View<const std::uint32_t>(p.keys), query, View<IndexedHit>(there));
  std::vector<RayHit> here, brute(p.rays.size());
  const PacketOutcome expected = trace_here(p, query, &here);
  for (std::size_t i = 0; i < here.size(); ++i) {
    ASSERT_EQ(there[i].triangle, here[i].triangle) << "ray " << i;
    ASSERT_EQ(float_bits(there[i].t), float_bits(here[i].t)) << "ray " << i;
  }
  EXPECT_EQ(outcome.chunks, expected.chunks);
  EXPECT_EQ(outcome.counts.tests, expected.counts.tests);
  EXPECT_EQ(outcome.counts.hits, expected.counts.hits);
  EXPECT_EQ(outcome.counts.final_tests, expected.counts.final_tests);
  if (query.early_out) return;
  ProgressMeter meter;
  intersect_brute_force(p.executor, p.arrays.view(), p.rays, query.facing, brute, &meter);
  for (std::size_t i = 0; i < brute.size(); ++i) {
    ASSERT_EQ(there[i].triangle, brute[i].triangle) << "ray " << i;
    ASSERT_EQ(float_bits(there[i].t), float_bits(brute[i].t)) << "ray " << i;
  }
}

struct PacketEmulation {
  Executor executor{2};
  test::GuardedMemory heap;
  FailingAllocator memory{heap};

  std::unique_ptr<PacketTracer> tracer(std::uint32_t capacity) {
    return make_emulated_packet_tracer(capacity, executor, heap, &memory);
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
        const std::unique_ptr<PacketTracer> tracer = emulation.tracer(capacity);
        tracer->set_scene(emulation.executor, packed.there());
        PacketQuery query;
        query.most_rays = capacity == 1 ? 16 : 256;
        expect_as_cpu(*tracer, packed, query);
        query.most_rays = capacity == 1 ? 1 : 7;
        query.facing = Facing::kSkipBackOfSingleSided;
        query.early_out = true;
        expect_as_cpu(*tracer, packed, query);
      }
    }
  }
  EXPECT_EQ(emulation.memory.alive(), 0u);
}

TEST(PacketTracer, KeysOfFewBits) {
  PacketEmulation emulation;
  Packed packed(emulation.executor, soup(soup_kinds().front(), 100, 3), 700, 64);
  const std::unique_ptr<PacketTracer> tracer = emulation.tracer(1000);
  tracer->set_scene(emulation.executor, packed.there());
  for (std::uint32_t& key : packed.keys) key >>= 26;
  PacketQuery query;
  query.key_bits = 6;
  query.most_rays = 5;  // fewer than share a key
  expect_as_cpu(*tracer, packed, query);
}

TEST(PacketTracer, FewRaysFewTrianglesAndNone) {
  PacketEmulation emulation;
  const std::unique_ptr<PacketTracer> tracer = emulation.tracer(100);
  for (const std::uint32_t rays : {0u, 1u, 2u, 257u}) {
    for (const std::uint32_t triangles : {1u, 9u}) {
      const Packed packed(emulation.executor, soup(soup_kinds().front(), triangles, 3), rays, 3);
      tracer->set_scene(emulation.executor, packed.there());
      expect_as_cpu(*tracer, packed, {});
    }
  }
  const Packed packed(emulation.executor, soup(soup_kinds().front(), 1, 3), 9, 3);
  tracer->set_scene(emulation.executor, {});
  std::vector<IndexedHit> hits(9, IndexedHit{0, 0, 0, 1});
  static_cast<void>(tracer->trace(View<const Ray>(packed.rays),
                                  View<const std::uint32_t>(packed.keys), {},
                                  View<IndexedHit>(hits)));
  for (const IndexedHit& hit : hits) EXPECT_EQ(hit.triangle, kInvalidId);
}

TEST(PacketTracer, MemoryThatRunsOutAnywhereLeavesItUsable) {
  PacketEmulation emulation;
  const Packed packed(emulation.executor, soup(soup_kinds().front(), 60, 3), 70, 30);
  PacketQuery query;
  query.most_rays = 16;
  std::uint64_t allowed = 0;
  for (bool failed = true; failed; ++allowed) {
    const std::unique_ptr<PacketTracer> tracer = emulation.tracer(64);
    failed = false;
    emulation.memory.let(allowed);
    try {
      tracer->set_scene(emulation.executor, packed.there());
      expect_as_cpu(*tracer, packed, query);
    } catch (const Error& error) {
      failed = true;
      EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory);
      EXPECT_NE(error.place().find(": "), std::string::npos) << "a stage: " << error.place();
    }
    emulation.memory.let(FailingAllocator::kAlways);
    tracer->set_scene(emulation.executor, packed.there());
    expect_as_cpu(*tracer, packed, query);
  }
  EXPECT_GT(allowed, 20u);
  EXPECT_EQ(emulation.memory.alive(), 0u);
}

}  // namespace
}  // namespace raysheaf::test
