// Method `dual` in the renderer: brute force's image for all kinds of lights, rays and threads; one
// query per light; one tree per frame; and counts within the limits that the paper's scenes set.
#include <gtest/gtest.h>

#include "raysheaf/builtin_scenes.h"
#include "raysheaf/io.h"
#include "raysheaf/lab.h"
#include "raysheaf/method.h"
#include "raysheaf/render.h"
#include "render/frame/dual_tracer.h"
#include "support/pictures.h"
#include "support/scenes.h"

namespace raysheaf {
namespace {

RenderOptions options_of(Method method, std::uint32_t size = 40) {
  RenderOptions options = test::small_options(size);
  options.method = method;
  options.count_pixel_tests = true;
  return options;
}

void expect_as_brute_force(const SceneDescription& scene, std::uint32_t size = 40,
                           std::uint32_t bounces = 2) {
  RenderOptions options = options_of(Method::kBrute, size);
  options.bounces = bounces;
  const RenderResult expected = render(scene, options);
  options.method = Method::kDual;
  const RenderResult result = render(scene, options);
  EXPECT_TRUE(test::same_bits(result.beauty, expected.beauty));
  EXPECT_TRUE(test::same_bits(result.position, expected.position));
  EXPECT_EQ(result.shadow, expected.shadow);
  const auto &ours = result.statistics.batches, &theirs = expected.statistics.batches;
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_EQ(ours[i].rays, theirs[i].rays);
    EXPECT_EQ(ours[i].hits, theirs[i].hits) << to_string(ours[i].kind) << " " << ours[i].bounce;
  }
}

Light light_of(Light::Type type, Vec3 position, float intensity) {
  Light light = test::point_light(position, intensity);
  light.type = type;
  light.direction = normalized(Vec3{0, 0.5f, 0} - position);
  return light;
}

SceneDescription with_all_lights() {
  SceneDescription scene = test::ball_on_floor();
  scene.lights.push_back(light_of(Light::Type::kDirectional, {1, 3, 2}, 1));
  scene.lights.push_back(light_of(Light::Type::kDirectional, {-1, 3, 1}, 1));
  scene.lights.push_back(light_of(Light::Type::kSpot, {-2, 5, 3}, 50));
  scene.lights.push_back(light_of(Light::Type::kPoint, {-3, 2, 2}, 30));
  return scene;
}

TEST(Dual, LightsOfEveryTypeThrowTheSameShadows) {
  expect_as_brute_force(with_all_lights(), 64);
}

TEST(Dual, GlassAndMirrorsShowTheSame) {
  Material glass;
  glass.transmission = 1;
  glass.roughness = 0;
  expect_as_brute_force(test::ball_on_floor(glass), 40, 5);
  Material mirror;
  mirror.metallic = 1;
  mirror.roughness = 0;
  expect_as_brute_force(test::ball_on_floor(mirror));
}

TEST(Dual, OnlyPrimaryRaysPassBacksOfSingleSidedTriangles) {
  SceneDescription scene = test::ball_on_floor();
  for (Material& material : scene.materials) material.double_sided = false;
  scene.cameras[0] = test::camera_at({0.2f, 1.1f, 0.1f}, {0, 0.8f, 3});  // inside the sphere
  expect_as_brute_force(scene);
  Instance mirrored = scene.instances[0];
  mirrored.to_world.m[0][0] = -1;
  scene.instances[0] = mirrored;
  expect_as_brute_force(scene);
}

TEST(Dual, TrianglesWithoutAreaDoNoHarm) {
  SceneDescription scene = with_all_lights();
  Mesh points;
  for (int i = 0; i < 40; ++i) {
    const Vec3 p{0.1f * static_cast<float>(i), 1, 1};
    test::add_triangle(&points, p, p, p);
    test::add_triangle(&points, p, p + Vec3{1, 1, 1}, p + Vec3{2, 2, 2});
  }
  test::add_mesh(&scene, std::move(points));
  expect_as_brute_force(scene);
}

TEST(Dual, DoesNotDependOnTheNumberOfThreads) {
  for (const SceneDescription& scene : {with_all_lights(), builtin_scene("office")}) {
    RenderOptions options = options_of(Method::kDual, 96);
    options.threads = 1;
    const RenderResult one = render(scene, options);
    options.threads = 2;
    const RenderResult two = render(scene, options);
    EXPECT_TRUE(test::same_bits(one.beauty, two.beauty));
    ASSERT_EQ(one.statistics.batches.size(), two.statistics.batches.size());
    for (std::size_t i = 0; i < one.statistics.batches.size(); ++i) {
      const BatchStatistics &a = one.statistics.batches[i], &b = two.statistics.batches[i];
      EXPECT_EQ(a.bound_tests, b.bound_tests);
      EXPECT_EQ(a.ray_bound_tests, b.ray_bound_tests);
      EXPECT_EQ(a.final_tests, b.final_tests);
      EXPECT_EQ(a.plan, b.plan);
    }
  }
}

TEST(Dual, EarlyOutChangesNothing) {
  RenderOptions options = options_of(Method::kDual);
  const RenderResult plain = render(builtin_scene("office"), options);
  options.early_out = true;
  const RenderResult early = render(builtin_scene("office"), options);
  EXPECT_TRUE(test::same_bits(plain.beauty, early.beauty));
  for (std::size_t i = 0; i < plain.statistics.batches.size(); ++i)
    EXPECT_EQ(plain.statistics.batches[i].total_tests(), early.statistics.batches[i].total_tests());
}

TEST(Dual, TheTreeIsBuiltOnceAFrame) {
  const RenderResult result = render(builtin_scene("cornell"), options_of(Method::kDual, 64));
  int built = 0;
  for (const BatchStatistics& batch : result.statistics.batches) {
    for (const std::string& sentence : batch.plan)
      built += sentence.find("these triangles are new") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(built, 1);
}

/// `counts[l]` rays of light l; the rays of a light in `parallel` have different origins.
RayBatch batch_of(const std::vector<std::size_t>& counts,
                  const std::vector<std::uint32_t>& parallel) {
  RayBatch batch;
  for (std::uint32_t l = 0; l < counts.size(); ++l) {
    const bool apart = std::find(parallel.begin(), parallel.end(), l) != parallel.end();
    for (std::size_t i = 0; i < counts[l]; ++i) {
      const float x = static_cast<float>(l) + (apart ? 1e-3f * static_cast<float>(i) : 0.0f);
      batch.rays.push_back({{x, 0, 0}, 0, {0, 0, 1}, 1});
    }
    batch.light_ends.push_back(static_cast<std::uint32_t>(batch.rays.size()));
  }
  return batch;
}

TEST(Dual, PointLightsHaveQueriesOfTheirOwn) {
  using Ends = std::vector<std::size_t>;
  EXPECT_EQ(query_ends(batch_of({900}, {})), (Ends{0, 900}));
  EXPECT_EQ(query_ends(batch_of({900, 800}, {})), (Ends{0, 900, 1700}));
  EXPECT_EQ(query_ends(batch_of({900, 700, 600, 800}, {1, 2})), (Ends{0, 900, 2200, 3000}));
  EXPECT_EQ(query_ends(batch_of({10, 20, 900, 30, 40}, {})), (Ends{0, 30, 930, 1000}));
  EXPECT_EQ(query_ends(batch_of({0, 900, 0}, {})), (Ends{0, 900}));
  RayBatch unlit = batch_of({900}, {0});
  unlit.light_ends.clear();
  EXPECT_EQ(query_ends(unlit), (Ends{0, 900}));
}

/// The limit of tests, as a fraction of brute force's.
struct PaperLimit {
  const char* scene;
  double shadow;  ///< in groups, as in a frame, and as one query, as in the laboratory
  double all;     ///< of a frame
};

class DualOnPaperScenes : public testing::TestWithParam<PaperLimit> {};

TEST_P(DualOnPaperScenes, NeedsFewTestsAndMeetsTheSame) {
  const PaperLimit limit = GetParam();
  RAYSHEAF_SCENE_OR_SKIP(path, std::string("paper/") + limit.scene + ".glb");
  const SceneDescription scene = load_scene(path);
  const RenderResult result = render(scene, options_of(Method::kDual, 512));
  EXPECT_TRUE(test::same_bits(result.beauty, render(scene, options_of(Method::kCrsh, 512)).beauty));
  double tests = 0, brute_force = 0;
  for (const BatchStatistics& batch : result.statistics.batches) {
    if (batch.kind == RayKind::kPrimary) continue;
    tests += static_cast<double>(batch.total_tests());
    brute_force += static_cast<double>(batch.brute_force_tests());
    if (batch.kind == RayKind::kShadow) {
      EXPECT_LE(batch.relative(), limit.shadow) << batch.bounce;
    }
  }
  EXPECT_LE(tests, limit.all * brute_force);
  Laboratory laboratory(scene, 512, 512);
  EXPECT_LE(laboratory.measure(LabRays::kShadow, method_settings(Method::kDual), false).relative(),
            limit.shadow);
}
INSTANTIATE_TEST_SUITE_P(Scenes, DualOnPaperScenes,
                         testing::Values(PaperLimit{"office", 0.0008, 1},
                                         PaperLimit{"cornell", 0.025, 0.025},
                                         PaperLimit{"sponza", 0.00065, 1}),
                         [](const auto& test) { return std::string(test.param.scene); });

}  // namespace
}  // namespace raysheaf
