// `rah` and `crsh` on a device: brute force's hits and the CPU's counts, with lists of any
// capacity.
#include "methods/ray_hierarchy/pair_tracer.h"
#include "emulated/open_emulated.h"

#include <gtest/gtest.h>

#include <random>

#include "device/device_queries.h"
#include "intersect/brute_force.h"
#include "rays/order/order.h"
#include "raysheaf/error.h"
#include "scene/flat_arrays.h"
#include "support/soups.h"
#include "tests/support/device_memory.h"
#include "tests/support/guarded_memory.h"

namespace raysheaf::test {
namespace {

/// A flat scene in the form that a device takes, kept alive.
struct Copied {
  std::vector<Vec3> corners;
  std::vector<PairMesh> meshes;
  PairScene scene;

  explicit Copied(const FlatScene& flat) {
    const FlatArrays arrays(Executor(1), flat);
    for (std::uint32_t i = 0; i < flat.triangle_count; ++i)
      for (int k = 0; k < 3; ++k) corners.push_back(arrays.view().corner(i, k));
    for (const FlatMesh& mesh : flat.meshes)
      meshes.push_back({mesh.bound, mesh.first_triangle, mesh.triangle_count});
    scene = {{View<const Vec3>(corners),
              View<const std::uint8_t>(flat.flags.data(), flat.triangle_count)},
             View<const PairMesh>(meshes)};
  }
};

struct TracerEmulation {
  Executor executor{2};
  test::GuardedMemory heap;
  FailingAllocator memory{heap};

  std::unique_ptr<PairTracer> tracer(std::uint32_t capacity) {
    return make_emulated_pair_tracer(capacity, executor, heap, &memory);
  }
};

struct Case {
  const FlatScene& flat;
  const std::vector<Ray>& rays;
  const std::vector<std::uint32_t>& keys;
  PairQuery query;
};

/// Runs the CPU's stages on the same rays.
TraverseCounts counts_of_cpu(const Executor& executor, const Case& c, std::uint64_t* chunks) {
  std::vector<std::uint32_t> order(c.rays.size());
  std::iota(order.begin(), order.end(), 0u);
  if (!c.keys.empty())
    *chunks = order_by_key(executor, c.keys, View<std::uint32_t>(order), c.query.key_bits);
  std::vector<Ray> sorted;
  for (const std::uint32_t ray : order) sorted.push_back(c.rays[ray]);
  const auto tree =
      build_hierarchy<RayBound>(executor, sorted, c.flat.bounds, c.query.branching, c.query.levels);
  TraverseOptions options;
  options.mesh_culling = c.query.mesh_culling;
  options.facing = c.query.facing;
  std::vector<RayHit> best(sorted.size());
  ProgressMeter meter;
  return traverse(executor, FlatArrays(executor, c.flat).view(),
                  View<const FlatMesh>(c.flat.meshes), tree, sorted, options, best, {}, &meter);
}

void expect_as_cpu(PairTracer& tracer, const Executor& executor, const Case& c) {
  std::vector<IndexedHit> hits(c.rays.size(), IndexedHit{-1, -1, -1, 7});
  const PairOutcome outcome = tracer.trace(
      View<const Ray>(c.rays), View<const std::uint32_t>(c.keys), c.query, View<IndexedHit>(hits));
  std::vector<RayHit> expected(c.rays.size());
  ProgressMeter meter;
  intersect_brute_force(executor, FlatArrays(executor, c.flat).view(), c.rays, c.query.facing,
                        expected, &meter);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    ASSERT_EQ(hits[i].triangle, expected[i].triangle) << "ray " << i;
    ASSERT_EQ(float_bits(hits[i].t), float_bits(expected[i].t)) << "ray " << i;
  }
  std::uint64_t chunks = 0;
  const TraverseCounts counts = counts_of_cpu(executor, c, &chunks);
  EXPECT_EQ(outcome.chunks, chunks);
  EXPECT_EQ(outcome.counts.mesh_sphere_tests, counts.mesh_sphere_tests);
  EXPECT_EQ(outcome.counts.tests, counts.tests);
  EXPECT_EQ(outcome.counts.hits, counts.hits);
  EXPECT_EQ(outcome.counts.final_tests, counts.final_tests);
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
      const std::unique_ptr<PairTracer> tracer = emulation.tracer(capacity);
      tracer->set_scene(copied.scene);
      PairQuery query;
      query.levels = capacity == 7 ? 3 : 2;
      query.branching = capacity == 1000 ? 5 : 8;
      if (capacity == 1) query.levels = 1;
      for (const bool culling : {false, true}) {
        query.mesh_culling = culling;
        const std::vector<std::uint32_t> none;
        expect_as_cpu(*tracer, emulation.executor, {flat, rays, culling ? keys : none, query});
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
  const std::unique_ptr<PairTracer> tracer = emulation.tracer(100);
  tracer->set_scene(copied.scene);
  for (const std::uint32_t count : {0u, 1u, 7u, 8u, 9u, 64u, 65u}) {
    const std::vector<Ray> rays = rays_at(scene, count, 5);
    PairQuery query;
    query.levels = 2;
    expect_as_cpu(*tracer, emulation.executor,
                  {flat, rays, std::vector<std::uint32_t>(rays.size(), 3), query});
  }
  tracer->set_scene({});
  const std::vector<Ray> rays = rays_at(scene, 9, 5);
  std::vector<IndexedHit> hits(9, IndexedHit{0, 0, 0, 1});
  static_cast<void>(tracer->trace(View<const Ray>(rays), {}, {}, View<IndexedHit>(hits)));
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
    const std::unique_ptr<PairTracer> tracer = emulation.tracer(64);
    failed = false;
    emulation.memory.let(allowed);
    try {
      tracer->set_scene(copied.scene);
      expect_as_cpu(*tracer, emulation.executor, {flat, rays, keys, {}});
    } catch (const Error& error) {
      failed = true;
      EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory);
      EXPECT_NE(error.place().find(": "), std::string::npos) << "a stage: " << error.place();
    }
    emulation.memory.let(FailingAllocator::kAlways);
    tracer->set_scene(copied.scene);
    expect_as_cpu(*tracer, emulation.executor, {flat, rays, keys, {}});
  }
  EXPECT_GT(allowed, 20u);
  EXPECT_EQ(emulation.memory.alive(), 0u);
}

}  // namespace
}  // namespace raysheaf::test
