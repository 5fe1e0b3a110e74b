#include "paper/packets/packet_traverse.h"

#include <gtest/gtest.h>

#include <numeric>

#include "paper/base/flat_arrays.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "render/frame/brute_force.h"
#include "support/pictures.h"
#include "support/scenes.h"

namespace raysheaf {
namespace {

using test::SoupKind;

FlatScene flat(const SceneDescription& scene) {
  const Executor executor(2);
  return flatten(executor, scene, mesh_bounds(executor, scene));
}

std::vector<RayHit> brute(const FlatScene& scene, const std::vector<Ray>& rays, Facing facing) {
  std::vector<RayHit> hits(rays.size());
  ProgressMeter meter;
  intersect_brute_force(Executor(2), scene.source(), rays, facing, hits, &meter);
  return hits;
}

struct Outcome {
  std::vector<RayHit> hits;  ///< in the original order of the rays
  std::vector<float> ray_tests;
  PacketCounts counts;
};

Outcome run(const FlatScene& scene, const std::vector<Ray>& rays, const PacketOptions& options,
            std::uint32_t threads = 2, std::uint32_t most_rays = kPacketRays) {
  const Executor executor(threads);
  std::vector<std::uint32_t> order(rays.size());
  std::iota(order.begin(), order.end(), 0u);
  const std::vector<Packet> packets = make_packets(executor, rays, {}, 32, most_rays, order);
  std::vector<Ray> ordered(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) ordered[i] = rays[order[i]];
  const FlatArrays arrays(executor, scene);
  const Bvh bvh = build_bvh(executor, arrays.view());
  std::vector<RayHit> best(rays.size());
  Outcome result;
  result.hits.resize(rays.size());
  result.ray_tests.resize(rays.size());
  ProgressMeter meter;
  result.counts = traverse_packets(executor, arrays.view(), bvh, packets, ordered, options, best,
                                   result.ray_tests, &meter);
  for (std::size_t i = 0; i < rays.size(); ++i) result.hits[order[i]] = best[i];
  return result;
}

void expect_same(const std::vector<RayHit>& a, const std::vector<RayHit>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].triangle, b[i].triangle) << "ray " << i;
    ASSERT_EQ(a[i].t, b[i].t) << "ray " << i;
  }
}

void expect_brute(const SceneDescription& scene, const std::vector<Ray>& rays) {
  const FlatScene triangles = flat(scene);
  for (const Facing facing : {Facing::kBoth, Facing::kSkipBackOfSingleSided}) {
    const std::vector<RayHit> expected = brute(triangles, rays, facing);
    for (const std::uint32_t most_rays : {1u, 16u, 256u}) {
      PacketOptions options;
      options.facing = facing;
      expect_same(run(triangles, rays, options, 2, most_rays).hits, expected);
    }
  }
}

TEST(PacketTraverse, FindsWhatBruteForceFinds) {
  for (const SoupKind kind : test::soup_kinds()) {
    SCOPED_TRACE("kind " + std::to_string(static_cast<int>(kind)));
    const SceneDescription scene = test::soup(kind, 400, 21);
    expect_brute(scene, test::rays_at(scene, 1000, 22));
  }
}

TEST(PacketTraverse, OneTriangle) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const SceneDescription scene = test::soup(SoupKind::kSmall, 1, seed);
    expect_brute(scene, test::rays_at(scene, 200, seed));
  }
}

TEST(PacketTraverse, OneRay) {
  const SceneDescription scene = test::soup(SoupKind::kLarge, 300, 5);
  for (std::uint64_t seed = 1; seed < 50; ++seed)
    expect_brute(scene, test::rays_at(scene, 1, seed));
}

TEST(PacketTraverse, OppositeRaysAndEqualTriangles) {
  Mesh mesh;
  for (int i = 0; i < 1000; ++i) test::add_triangle(&mesh, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
  SceneDescription scene;
  test::add_mesh(&scene, std::move(mesh));
  std::vector<Ray> rays;
  for (int i = 0; i < 600; ++i) {
    const float side = i % 2 == 0 ? 1.0f : -1.0f;
    rays.push_back({{0, 0, side}, 0, {0, 0, -side}, i % 3 == 0 ? 1.0f : 0.999f});
  }
  const Outcome r = run(flat(scene), rays, {});
  for (std::size_t i = 0; i < rays.size(); ++i)
    EXPECT_EQ(r.hits[i].triangle, i % 3 == 0 ? 0u : kInvalidId);
  expect_brute(scene, rays);
}

TEST(PacketTraverse, ASceneWithoutAreaOrWithoutTrianglesIsNeverMet) {
  SceneDescription scene;
  Mesh mesh;
  for (int i = 0; i < 50; ++i) test::add_triangle(&mesh, {1, 2, 3}, {1, 2, 3}, {2, 2, 3});
  test::add_mesh(&scene, std::move(mesh));
  const std::vector<Ray> rays = test::rays_at(scene, 100, 3);
  for (const RayHit& hit : run(flat(scene), rays, {}).hits) EXPECT_FALSE(hit.found());
  for (const RayHit& hit : run(flat(SceneDescription{}), rays, {}).hits) EXPECT_FALSE(hit.found());
}

TEST(PacketTraverse, SmallQueuesDropNothingAndChangeNoCount) {
  const SceneDescription scene = test::soup(SoupKind::kLarge, 2000, 71);
  const FlatScene triangles = flat(scene);
  const std::vector<Ray> rays = test::rays_at(scene, 4000, 72);
  const Outcome large = run(triangles, rays, {});
  PacketOptions options;
  options.pair_capacity = 1;
  const Outcome small = run(triangles, rays, options);
  expect_same(small.hits, large.hits);
  EXPECT_EQ(small.counts.tests, large.counts.tests);
  EXPECT_EQ(small.counts.hits, large.counts.hits);
  EXPECT_EQ(small.counts.final_tests, large.counts.final_tests);
  EXPECT_EQ(small.ray_tests, large.ray_tests);
}

TEST(PacketTraverse, DoesNotDependOnTheNumberOfThreads) {
  const SceneDescription scene = test::soup(SoupKind::kSmall, 3000, 61);
  const FlatScene triangles = flat(scene);
  const std::vector<Ray> rays = test::rays_at(scene, 5000, 62);
  const Outcome one = run(triangles, rays, {}, 1);
  for (const std::uint32_t threads : {2u, 5u}) {
    const Outcome many = run(triangles, rays, {}, threads);
    expect_same(one.hits, many.hits);
    EXPECT_EQ(one.counts.tests, many.counts.tests);
    EXPECT_EQ(one.counts.hits, many.counts.hits);
    EXPECT_EQ(one.counts.final_tests, many.counts.final_tests);
    EXPECT_EQ(one.ray_tests, many.ray_tests);
  }
}

TEST(PacketTraverse, RayTestsAddUpToTheTestsThatWereDone) {
  const SceneDescription scene = test::soup(SoupKind::kSmall, 2000, 41);
  const Outcome r = run(flat(scene), test::rays_at(scene, 3000, 42), {});
  const double sum = std::accumulate(r.ray_tests.begin(), r.ray_tests.end(), 0.0);
  const auto expected = static_cast<double>(
      std::accumulate(r.counts.tests.begin(), r.counts.tests.end(), r.counts.final_tests));
  EXPECT_NEAR(sum, expected, 1e-4 * expected);
}

TEST(PacketTraverse, LevelsFollowFromOneAnother) {
  const SceneDescription scene = test::soup(SoupKind::kSmall, 3000, 43);
  const Outcome r = run(flat(scene), test::rays_at(scene, 3000, 44), {});
  const auto& c = r.counts;
  for (std::size_t l = 0; l < c.tests.size(); ++l) EXPECT_LE(c.hits[l], c.tests[l]);
  for (std::size_t l = 1; l + 1 < c.tests.size(); ++l)
    EXPECT_LE(c.tests[l], kBvhWidth * c.hits[l + 1]);
  EXPECT_LE(c.tests[0],
            kLeafTriangles * std::accumulate(c.hits.begin() + 1, c.hits.end(), std::uint64_t{0}));
}

TEST(PacketTraverse, EarlyOutFindsTheSameRaysOccludedWithFewerTests) {
  const SceneDescription scene = test::soup(SoupKind::kLarge, 12000, 51);
  const FlatScene triangles = flat(scene);
  const std::vector<Ray> rays = test::rays_at(scene, 2000, 52);
  PacketOptions options;
  const Outcome all = run(triangles, rays, options);
  options.early_out = true;
  const Outcome early = run(triangles, rays, options);
  for (std::size_t i = 0; i < rays.size(); ++i)
    EXPECT_EQ(all.hits[i].found(), early.hits[i].found());
  EXPECT_LE(early.counts.final_tests, all.counts.final_tests);
}

RenderOptions options_of(Method method) {
  RenderOptions options = test::small_options(48);
  options.method = method;
  options.count_pixel_tests = true;
  return options;
}

TEST(Gl10, RendersBuiltinScenesAsBruteForceDoes) {
  for (const char* name : {"office", "cornell", "atrium"}) {
    const SceneDescription scene = builtin_scene(name);
    const RenderResult expected = render(scene, options_of(Method::kBrute));
    for (const bool early_out : {false, true}) {
      RenderOptions options = options_of(Method::kGl10);
      options.early_out = early_out;
      const RenderResult result = render(scene, options);
      EXPECT_TRUE(test::same_bits(result.beauty, expected.beauty)) << name;
      EXPECT_TRUE(test::same_bits(result.position, expected.position)) << name;
      for (const BatchStatistics& batch : result.statistics.batches) {
        EXPECT_GT(batch.chunks, 0u);
        EXPECT_LT(batch.relative(), 0.5) << name;
      }
    }
  }
}

class PaperScenes : public testing::TestWithParam<const char*> {};

TEST_P(PaperScenes, RenderAsBruteForceDoes) {
  RAYSHEAF_SCENE_OR_SKIP(path, std::string("paper/") + GetParam() + ".glb");
  const SceneDescription scene = load_scene(path);
  RenderOptions brute = options_of(Method::kBrute), gl10 = options_of(Method::kGl10);
  brute.width = brute.height = gl10.width = gl10.height = 128;
  const RenderResult result = render(scene, gl10);
  EXPECT_TRUE(test::same_bits(result.beauty, render(scene, brute).beauty));
  for (const BatchStatistics& batch : result.statistics.batches)
    EXPECT_LT(batch.relative(), 0.1) << to_string(batch.kind) << " " << batch.bounce;
}
INSTANTIATE_TEST_SUITE_P(Gl10, PaperScenes, testing::Values("office", "cornell", "sponza"));

TEST(Gl10, RendersSoupsAsBruteForceDoes) {
  for (const SoupKind kind : test::soup_kinds()) {
    const SceneDescription scene = test::soup(kind, 400, 17);
    EXPECT_TRUE(test::same_bits(render(scene, options_of(Method::kGl10)).beauty,
                                render(scene, options_of(Method::kBrute)).beauty))
        << "kind " << static_cast<int>(kind);
  }
}

TEST(Gl10, CanBeCancelled) {
  RenderOptions options = options_of(Method::kGl10);
  int calls = 0;
  options.progress = [&](const Progress&) { return ++calls < 5; };
  EXPECT_THROW((void)render(builtin_scene("office"), options), Error);
}

}  // namespace
}  // namespace raysheaf
