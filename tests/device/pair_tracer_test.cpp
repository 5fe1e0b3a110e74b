// `rah` and `crsh` on a device: brute force's hits and the CPU's counts, with lists of any
// capacity.
#include "paper/ray_hierarchy/pair_tracer_device.h"

#include "emulated/emulated_device.h"

#include <gtest/gtest.h>

#include <random>

#include "device/device_queries.h"
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

/// The triangles of a flat scene in the form that a device takes, kept alive.
struct Copied {
  const FlatScene& flat;
  std::vector<Vec3> corners;

  explicit Copied(const FlatScene& scene) : flat(scene) {
    const FlatArrays arrays(Executor(1), flat);
    for (std::uint32_t i = 0; i < flat.triangle_count; ++i)
      for (int k = 0; k < 3; ++k) corners.push_back(arrays.view().corner(i, k));
  }
  void give_to(DeviceBatchTracer* tracer) const {
    tracer->set_scene(Executor(1), flat,
                      {View<const Vec3>(corners),
                       View<const std::uint8_t>(flat.flags.data(), flat.triangle_count)});
  }
};

struct TracerEmulation {
  Executor executor{2};
  test::GuardedMemory heap;
  FailingAllocator memory{heap};

  std::unique_ptr<DeviceBatchTracer> tracer(std::uint32_t capacity) {
    return std::make_unique<PairTracerOn<EmulatedDevice>>(capacity, executor, heap, &memory);
  }
};

struct Case {
  const FlatScene& flat;
  const std::vector<Ray>& rays;
  const std::vector<std::uint32_t>& keys;
  BatchOptions options;
};

/// Runs the CPU's stages on the same rays.
BatchStatistics counts_of_cpu(const Executor& executor, const Case& c) {
  BatchStatistics statistics;
  const MethodSettings& method = c.options.method;
  std::vector<std::uint32_t> order(c.rays.size());
  std::iota(order.begin(), order.end(), 0u);
  if (!c.keys.empty())
    statistics.chunks = order_by_key(executor, c.keys, View<std::uint32_t>(order));
  std::vector<Ray> sorted;
  for (const std::uint32_t ray : order) sorted.push_back(c.rays[ray]);
  const auto tree =
      build_hierarchy<RayBound>(executor, sorted, c.flat.bounds, method.branching, method.levels);
  TraverseOptions options;
  options.mesh_culling = method.mesh_culling;
  options.facing = c.options.facing;
  std::vector<RayHit> best(sorted.size());
  ProgressMeter meter;
  traverse(executor, FlatArrays(executor, c.flat).view(), View<const FlatMesh>(c.flat.meshes), tree,
           sorted, options, best, {}, &meter)
      .add_to(&statistics);
  return statistics;
}

void expect_as_cpu(DeviceBatchTracer& tracer, const Executor& executor, const Case& c) {
  std::vector<IndexedHit> hits(c.rays.size(), IndexedHit{-1, -1, -1, 7});
  BatchStatistics counts;
  tracer.trace(View<const Ray>(c.rays), View<const std::uint32_t>(c.keys), 32, c.options,
               View<IndexedHit>(hits), &counts, nullptr);
  std::vector<RayHit> expected(c.rays.size());
  ProgressMeter meter;
  intersect_brute_force(executor, c.flat.source(), c.rays, c.options.facing, expected, &meter);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    ASSERT_EQ(hits[i].triangle, expected[i].triangle) << "ray " << i;
    ASSERT_EQ(float_bits(hits[i].t), float_bits(expected[i].t)) << "ray " << i;
  }
  expect_same_counts(counts, counts_of_cpu(executor, c));
}

TEST(PairTracer, FindsTheHitsAndCountsAsTheCpu) {
  TracerEmulation emulation;
  std::mt19937 random(1);
  for (const SoupKind kind : soup_kinds()) {
    const SceneDescription scene = soup(kind, 150, 21);
    const FlatScene flat =
        flatten(emulation.executor, scene, mesh_bounds(emulation.executor, scene));
    const Copied copied(flat);
    const std::vector<Ray> rays = rays_at(scene, 133, 5);
    std::vector<std::uint32_t> keys(rays.size());
    for (std::uint32_t& key : keys) key = static_cast<std::uint32_t>(random() % 40) * 1000;
    for (const std::uint32_t capacity : {1u, 7u, 1000u, 1u << 20}) {
      SCOPED_TRACE(capacity);
      if (capacity == 1 && kind != soup_kinds().front()) continue;
      const std::unique_ptr<DeviceBatchTracer> tracer = emulation.tracer(capacity);
      copied.give_to(tracer.get());
      BatchOptions options;
      options.method.levels = capacity == 7 ? 3 : 2;
      options.method.branching = capacity == 1000 ? 5 : 8;
      if (capacity == 1) options.method.levels = 1;
      for (const bool culling : {false, true}) {
        options.method.mesh_culling = culling;
        const std::vector<std::uint32_t> none;
        expect_as_cpu(*tracer, emulation.executor, {flat, rays, culling ? keys : none, options});
      }
    }
  }
  EXPECT_EQ(emulation.memory.alive(), 0u);
}

TEST(PairTracer, FewRaysFewTrianglesAndNone) {
  TracerEmulation emulation;
  const SceneDescription scene = soup(soup_kinds().front(), 5, 3);
  const FlatScene flat = flatten(emulation.executor, scene, mesh_bounds(emulation.executor, scene));
  const Copied copied(flat);
  const std::unique_ptr<DeviceBatchTracer> tracer = emulation.tracer(100);
  copied.give_to(tracer.get());
  for (const std::uint32_t count : {0u, 1u, 7u, 8u, 9u, 64u, 65u}) {
    const std::vector<Ray> rays = rays_at(scene, count, 5);
    BatchOptions options;
    options.method.levels = 2;
    expect_as_cpu(*tracer, emulation.executor,
                  {flat, rays, std::vector<std::uint32_t>(rays.size(), 3), options});
  }
  tracer->set_scene(emulation.executor, {}, {});
  const std::vector<Ray> rays = rays_at(scene, 9, 5);
  std::vector<IndexedHit> hits(9, IndexedHit{0, 0, 0, 1});
  BatchStatistics counts;
  tracer->trace(View<const Ray>(rays), {}, 32, {}, View<IndexedHit>(hits), &counts, nullptr);
  for (const IndexedHit& hit : hits) EXPECT_EQ(hit.triangle, kInvalidId);
}

TEST(PairTracer, MemoryThatRunsOutAnywhereLeavesItUsable) {
  TracerEmulation emulation;
  const SceneDescription scene = soup(soup_kinds().front(), 60, 3);
  const FlatScene flat = flatten(emulation.executor, scene, mesh_bounds(emulation.executor, scene));
  const Copied copied(flat);
  const std::vector<Ray> rays = rays_at(scene, 70, 5);
  const std::vector<std::uint32_t> keys(rays.size(), 1);
  std::uint64_t allowed = 0;
  for (bool failed = true; failed; ++allowed) {
    const std::unique_ptr<DeviceBatchTracer> tracer = emulation.tracer(64);
    failed = false;
    emulation.memory.let(allowed);
    try {
      copied.give_to(tracer.get());
      expect_as_cpu(*tracer, emulation.executor, {flat, rays, keys, {}});
    } catch (const Error& error) {
      failed = true;
      EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory);
      EXPECT_NE(error.place().find(": "), std::string::npos) << "a stage: " << error.place();
    }
    emulation.memory.let(FailingAllocator::kAlways);
    copied.give_to(tracer.get());
    expect_as_cpu(*tracer, emulation.executor, {flat, rays, keys, {}});
  }
  EXPECT_GT(allowed, 20u);
  EXPECT_EQ(emulation.memory.alive(), 0u);
}

}  // namespace
}  // namespace raysheaf::test
