#include "paper/ray_hierarchy/traverse.h"

#include <gtest/gtest.h>

#include "base/bits.h"
#include "paper/base/flat_arrays.h"
#include "render/frame/brute_force.h"
#include "support/soups.h"

namespace raysheaf {
namespace {

using test::SoupKind;

std::vector<RayHit> brute(const Executor& executor, const FlatScene& scene,
                          const std::vector<Ray>& rays) {
  std::vector<RayHit> hits(rays.size());
  ProgressMeter meter;
  intersect_brute_force(executor, scene.source(), rays, Facing::kBoth, hits, &meter);
  return hits;
}

struct Outcome {
  std::vector<RayHit> hits;
  std::vector<float> ray_tests;
  TraverseCounts counts;
};

Outcome run(const Executor& executor, const FlatScene& scene, const std::vector<Ray>& rays,
            std::uint32_t branching, std::uint32_t levels, TraverseOptions options,
            BundleBound bound = BundleBound::kSphereCone) {
  Outcome result;
  result.hits.resize(rays.size());
  result.ray_tests.resize(rays.size());
  ProgressMeter meter;
  const FlatArrays arrays(executor, scene);
  with_bound(bound, [&]<class Bound>(std::type_identity<Bound> /*type*/) {
    const auto tree = build_hierarchy<Bound>(executor, rays, scene.bounds, branching, levels);
    result.counts = traverse(executor, arrays.view(), View<const FlatMesh>(scene.meshes), tree,
                             rays, options, result.hits, result.ray_tests, &meter);
  });
  return result;
}

const std::vector<BundleBound>& every_bound() {
  static const std::vector<BundleBound> all{BundleBound::kSphereCone, BundleBound::kFiniteCone,
                                            BundleBound::kShaft, BundleBound::kFrustum,
                                            BundleBound::kShaftAndCone};
  return all;
}

void expect_same(const std::vector<RayHit>& a, const std::vector<RayHit>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].triangle, b[i].triangle) << "ray " << i;
    ASSERT_EQ(a[i].t, b[i].t) << "ray " << i;
  }
}

TEST(Traverse, FindsWhatBruteForceFinds) {
  const Executor executor(2);
  for (const SoupKind kind : test::soup_kinds()) {
    const SceneDescription scene = test::soup(kind, 200, 21);
    const FlatScene triangles = flatten(executor, scene, mesh_bounds(executor, scene));
    const std::vector<Ray> rays = test::rays_at(scene, 300, 22);
    const std::vector<RayHit> expected = brute(executor, triangles, rays);
    for (const bool mesh_culling : {false, true}) {
      for (const auto& [branching, levels] :
           {std::pair{8u, 2u}, {8u, 1u}, {2u, 5u}, {16u, 3u}, {64u, 8u}}) {
        SCOPED_TRACE("kind " + std::to_string(static_cast<int>(kind)) + " branching " +
                     std::to_string(branching));
        TraverseOptions options;
        options.mesh_culling = mesh_culling;
        for (const BundleBound bound : every_bound()) {
          SCOPED_TRACE(to_string(bound));
          expect_same(run(executor, triangles, rays, branching, levels, options, bound).hits,
                      expected);
        }
      }
    }
  }
}

void expect_paper_counts(const FlatScene& scene, const std::vector<Ray>& rays, BundleBound bound) {
  const std::uint64_t triangles = scene.triangle_count;
  const std::uint64_t nodes = div_ceil(div_ceil(div_ceil(rays.size(), 8), 8), 8);
  TraverseOptions rah;
  rah.mesh_culling = false;
  const TraverseCounts c = run(Executor(2), scene, rays, 8, 3, rah, bound).counts;
  EXPECT_EQ(c.tests[2], nodes * triangles);
  EXPECT_EQ(c.tests[1], 8 * c.hits[2]);
  EXPECT_EQ(c.tests[0], 8 * c.hits[1]);
  EXPECT_EQ(c.final_tests, 8 * c.hits[0]);
  EXPECT_EQ(c.mesh_sphere_tests, 0u);
  const TraverseCounts crsh = run(Executor(2), scene, rays, 8, 3, {}, bound).counts;
  EXPECT_EQ(crsh.mesh_sphere_tests, nodes * scene.meshes.size());
  EXPECT_LE(crsh.tests[2], c.tests[2]);
  EXPECT_EQ(crsh.tests[1], 8 * crsh.hits[2]);
  EXPECT_EQ(crsh.final_tests, 8 * crsh.hits[0]);
}

TEST(Traverse, CountsAsThePaperDoes) {
  const Executor executor(2);
  const SceneDescription scene = test::soup(SoupKind::kSmall, 900, 31);
  const FlatScene triangles = flatten(executor, scene, mesh_bounds(executor, scene));
  for (const std::uint32_t count : {1u, 8u, 63u, 64u, 65u, 777u}) {
    for (const BundleBound bound : every_bound()) {
      SCOPED_TRACE(to_string(bound));
      expect_paper_counts(triangles, test::rays_at(scene, count, count), bound);
    }
  }
}

TEST(Traverse, TwoBoundsMeetNoMoreThanEither) {
  const Executor executor(2);
  const SceneDescription scene = test::soup(SoupKind::kSmall, 900, 33);
  const FlatScene triangles = flatten(executor, scene, mesh_bounds(executor, scene));
  const std::vector<Ray> rays = test::rays_at(scene, 900, 34);
  TraverseOptions options;
  options.mesh_culling = false;
  const auto leaf_hits = [&](BundleBound bound) {
    return run(executor, triangles, rays, 8, 1, options, bound).counts.hits[0];
  };
  const std::uint64_t both = leaf_hits(BundleBound::kShaftAndCone);
  const std::uint64_t finite = leaf_hits(BundleBound::kFiniteCone);
  EXPECT_LE(both, leaf_hits(BundleBound::kShaft));
  EXPECT_LE(both, finite);
  EXPECT_LT(finite, leaf_hits(BundleBound::kSphereCone));
}

TEST(Traverse, RayTestsAddUpToTheTestsThatWereDone) {
  const Executor executor(2);
  const SceneDescription scene = test::soup(SoupKind::kSmall, 500, 41);
  const FlatScene triangles = flatten(executor, scene, mesh_bounds(executor, scene));
  const std::vector<Ray> rays = test::rays_at(scene, 512, 42);  // full nodes need no padding
  const Outcome r = run(executor, triangles, rays, 8, 2, {});
  double sum = 0;
  for (const float tests : r.ray_tests) sum += double{tests};
  const double expected =
      static_cast<double>(r.counts.tests[0] + r.counts.tests[1] + r.counts.final_tests);
  EXPECT_NEAR(sum, expected, 1e-4 * expected);
}

TEST(Traverse, FullListsDescendAndNothingIsDropped) {
  const Executor executor(2);
  Mesh mesh;
  test::Random random(5);
  for (std::uint32_t i = 0; i < 3 * kListCapacity + 17; ++i) {
    const float z = random.between(-1, 1);
    test::add_triangle(&mesh, {-9, -9, z}, {9, -9, z}, {0, 9, z});
  }
  SceneDescription scene;
  test::add_mesh(&scene, std::move(mesh));
  const FlatScene triangles = flatten(executor, scene, mesh_bounds(executor, scene));
  std::vector<Ray> rays;
  for (int i = 0; i < 100; ++i)
    rays.push_back({random.in_box(1) + Vec3{0, 0, 5}, 0, {0, 0, -1}, 100});
  const std::vector<RayHit> expected = brute(executor, triangles, rays);
  for (const BundleBound bound : every_bound()) {
    const Outcome r = run(executor, triangles, rays, 8, 2, {}, bound);
    expect_same(r.hits, expected);
    EXPECT_EQ(r.counts.tests[0], 8 * r.counts.hits[1]);
    EXPECT_EQ(r.counts.final_tests, 8 * r.counts.hits[0]);
  }
}

TEST(Traverse, EarlyOutFindsTheSameRaysOccludedWithFewerTests) {
  const Executor executor(2);
  const SceneDescription scene = test::soup(SoupKind::kLarge, 12000, 51);
  const FlatScene triangles = flatten(executor, scene, mesh_bounds(executor, scene));
  const std::vector<Ray> rays = test::rays_at(scene, 2000, 52);
  TraverseOptions options;
  const Outcome all = run(executor, triangles, rays, 8, 2, options);
  options.early_out = true;
  const Outcome early = run(executor, triangles, rays, 8, 2, options);
  for (std::size_t i = 0; i < rays.size(); ++i)
    EXPECT_EQ(all.hits[i].found(), early.hits[i].found());
  EXPECT_LT(early.counts.final_tests, all.counts.final_tests);
  // Counts match the tests that were made, except for the padding of nodes.
  double sum = 0;
  for (const float tests : early.ray_tests) sum += double{tests};
  const auto& c = early.counts;
  EXPECT_LE(sum, static_cast<double>(c.tests[0] + c.tests[1] + c.final_tests) * 1.0001);
  EXPECT_GE(sum, static_cast<double>(c.tests[1] + c.final_tests));
}

TEST(Traverse, DoesNotDependOnTheNumberOfThreads) {
  const SceneDescription scene = test::soup(SoupKind::kSmall, 900, 61);
  const FlatScene triangles = flatten(Executor(1), scene, mesh_bounds(Executor(1), scene));
  const std::vector<Ray> rays = test::rays_at(scene, 3000, 62);
  const Outcome one = run(Executor(1), triangles, rays, 8, 2, {});
  for (const std::uint32_t threads : {2u, 5u}) {
    const Outcome many = run(Executor(threads), triangles, rays, 8, 2, {});
    expect_same(one.hits, many.hits);
    EXPECT_EQ(one.counts.tests, many.counts.tests);
    EXPECT_EQ(one.counts.hits, many.counts.hits);
    EXPECT_EQ(one.ray_tests, many.ray_tests);
  }
}

TEST(Traverse, NoRaysNeedNoTests) {
  const Executor executor(2);
  const SceneDescription scene = test::soup(SoupKind::kSmall, 10, 1);
  const FlatScene triangles = flatten(executor, scene, mesh_bounds(executor, scene));
  const Outcome r = run(executor, triangles, {}, 8, 2, {});
  EXPECT_EQ(r.counts.final_tests, 0u);
}

}  // namespace
}  // namespace raysheaf
