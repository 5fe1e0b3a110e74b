// Images with several samples: one sample is deterministic, the mean converges, and only the number
// of samples changes the result.
#include <gtest/gtest.h>

#include <tuple>

#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "raysheaf/render.h"
#include "support/pictures.h"

namespace raysheaf {
namespace {

RenderOptions with_samples(std::uint32_t samples, std::uint32_t size = 32) {
  RenderOptions options = test::small_options(size);
  options.samples = samples;
  return options;
}

TEST(Samples, GiveTheSameBitsByEveryMethodAndOnEveryNumberOfThreads) {
  const SceneDescription scene = builtin_scene("office");
  RenderOptions options = with_samples(3);
  options.count_pixel_tests = true;
  options.method = Method::kBrute;
  options.threads = 1;
  const RenderResult brute = render(scene, options);
  EXPECT_EQ(brute.samples, 3u);
  for (const Method method : {Method::kRah, Method::kCrsh, Method::kGl10, Method::kDual}) {
    options.method = method;
    for (const std::uint32_t threads : {1u, 3u}) {
      options.threads = threads;
      const RenderResult result = render(scene, options);
      EXPECT_TRUE(test::same_bits(result.beauty, brute.beauty)) << to_string(method);
      EXPECT_TRUE(test::same_bits(result.normal, brute.normal)) << to_string(method);
      EXPECT_TRUE(test::same_bits(result.albedo, brute.albedo)) << to_string(method);
      EXPECT_EQ(result.shadow, brute.shadow) << to_string(method);
      EXPECT_EQ(result.exposure, brute.exposure) << to_string(method);
    }
  }
}

TEST(Samples, StatisticsAreTheSumAndEachByItself) {
  for (const Method method : {Method::kCrsh, Method::kDual}) {
    RenderOptions options = with_samples(4);
    options.method = method;
    options.count_pixel_tests = true;
    const RenderResult result = render(builtin_scene("cornell"), options);
    ASSERT_EQ(result.statistics.samples.size(), 4u);
    SampleStatistics sum, batches;
    for (const SampleStatistics& sample : result.statistics.samples) {
      EXPECT_GT(sample.rays, 0u);
      EXPECT_GT(sample.ms, 0);
      sum.rays += sample.rays;
      sum.total_tests += sample.total_tests;
      sum.hits += sample.hits;
    }
    for (const BatchStatistics& batch : result.statistics.batches) {
      batches.rays += batch.rays;
      batches.total_tests += batch.total_tests();
      batches.hits += batch.hits;
      EXPECT_LT(batch.plan.size(), 30u);  // of one sample, not of all
    }
    EXPECT_EQ(sum.rays, batches.rays);
    EXPECT_EQ(sum.total_tests, batches.total_tests);
    EXPECT_EQ(sum.hits, batches.hits);
    // crsh pads its last nodes, and the tests of the padding belong to no pixel.
    if (method == Method::kCrsh) continue;
    double pixels = 0;
    for (const float tests : result.tests) pixels += double{tests};
    EXPECT_NEAR(pixels, static_cast<double>(sum.total_tests), 1e-4 * pixels);
  }
}

TEST(Samples, ThePictureSoFarIsThatOfAsManySamples) {
  SceneDescription scene = builtin_scene("cornell");
  // With a single sample, a light with a size would be sampled at its centre.
  scene.lights[0].radius = 0;
  RenderOptions options = with_samples(5, 24);
  std::vector<RenderResult> so_far;
  options.on_sample = [&](const RenderResult& result) {
    so_far.push_back(result);
    return true;
  };
  const RenderResult last = render(scene, options);
  ASSERT_EQ(so_far.size(), 4u);
  double total_ms = 0;
  for (const RenderResult& part : so_far) {
    const FrameStatistics &s = part.statistics, &whole = last.statistics;
    EXPECT_EQ(std::tie(s.scene, s.triangles, s.meshes, s.width, s.height, s.method, s.key, s.bound),
              std::tie(whole.scene, whole.triangles, whole.meshes, whole.width, whole.height,
                       whole.method, whole.key, whole.bound));
    EXPECT_EQ(std::tie(s.device, s.primary, s.threads),
              std::tie(whole.device, whole.primary, whole.threads));
    EXPECT_GT(s.total_ms, total_ms);
    total_ms = s.total_ms;
  }
  EXPECT_GT(last.statistics.total_ms, total_ms);
  so_far.push_back(last);
  options.on_sample = nullptr;
  for (std::uint32_t n = 1; n <= 5; ++n) {
    options.samples = n;
    const RenderResult alone = render(scene, options);
    const RenderResult& part = so_far[n - 1];
    EXPECT_EQ(part.samples, n);
    EXPECT_TRUE(test::same_bits(alone.beauty, part.beauty)) << n;
    EXPECT_TRUE(test::same_bits(alone.albedo, part.albedo)) << n;
    EXPECT_TRUE(test::same_bits(alone.position, part.position)) << n;
    EXPECT_EQ(alone.exposure, part.exposure) << n;
    EXPECT_EQ(part.statistics.samples.size(), n);
  }
}

TEST(Samples, EndWhereTheCallerHasSeenEnough) {
  RenderOptions options = with_samples(1000, 16);
  options.on_sample = [](const RenderResult& so_far) { return so_far.samples < 3; };
  const RenderResult result = render(builtin_scene("cornell"), options);
  EXPECT_EQ(result.samples, 3u);
  EXPECT_EQ(result.statistics.samples.size(), 3u);
}

TEST(Samples, AreReportedAsOneStageAndCanBeCancelled) {
  RenderOptions options = with_samples(4, 16);
  std::uint64_t last = 0;
  options.progress = [&](const Progress& progress) {
    if (progress.stage == "scene") return true;
    EXPECT_EQ(progress.stage, "samples");
    EXPECT_EQ(progress.total, 4u);
    EXPECT_GE(progress.done, last);
    last = progress.done;
    return true;
  };
  (void)render(test::ball_on_floor(), options);
  EXPECT_EQ(last, 3u);
  options.progress = [](const Progress& progress) {
    return progress.stage == "scene" || progress.done < 2;
  };
  EXPECT_THROW((void)render(test::ball_on_floor(), options), Error);
}

/// A white square on black: the pixels at its edge hold the fraction that the filter sees.
SceneDescription half_white(float edge) {
  SceneDescription scene;
  Material white;
  white.unlit = true;
  white.emission = {1, 1, 1};
  scene.materials = {white};
  Mesh mesh;
  mesh.positions = {{edge, -9, 0}, {9, -9, 0}, {9, 9, 0}, {edge, 9, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.materials = {0};
  test::add_mesh(&scene, std::move(mesh));
  Camera camera = test::camera_at({0, 0, 5}, {0, 0, 0});
  camera.orthographic = true;
  camera.y_mag = 4;  // 8 pixels with side 1
  scene.cameras = {camera};
  return scene;
}

TEST(Samples, AnEdgeIsTheGaussiansIntegral) {
  for (const float edge : {0.0f, 0.3f, 0.5f}) {
    RenderOptions options = with_samples(256, 8);
    options.ambient = Vec3{0, 0, 0};
    const RenderResult result = render(half_white(edge), options);
    for (std::uint32_t x = 0; x < 8; ++x) {
      const double center = static_cast<double>(x) - 3.5;
      // The truncation changes the Gaussian's integral by at most 1.2 % (its tails beyond three
      // standard deviations).
      const double expected = 0.5 * std::erfc((double{edge} - center) / (0.5 * std::sqrt(2.0)));
      EXPECT_NEAR(result.beauty[3 * 8 + x].x, expected, 0.015) << edge << " " << x;
    }
  }
}

TEST(Samples, RasterAndTraceSeeTheSame) {
  for (const std::string name : {"office", "atrium"}) {
    RenderOptions options = with_samples(8, 96);
    options.bounces = 0;
    options.shadows = false;
    const RenderResult traced = render(builtin_scene(name), options);
    options.primary = Primary::kRaster;
    RenderResult raster;
    try {
      raster = render(builtin_scene(name), options);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::kNoGraphics) GTEST_SKIP() << error.what();
      throw;
    }
    int different = 0;
    for (std::size_t i = 0; i < traced.albedo.size(); ++i)
      different += max_component(abs(traced.albedo[i] - raster.albedo[i])) > 1e-4f ? 1 : 0;
    EXPECT_LE(different, 96 * 96 * 8 / 1000) << name;  // a tenth of a percent of the samples
  }
}

TEST(Samples, TheirNumberHasLimits) {
  for (const std::uint32_t samples : {65537u, 0xffffffffu}) {
    try {
      (void)render(test::ball_on_floor(), with_samples(samples));
      FAIL() << samples;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
      EXPECT_EQ(error.place(), "samples");
    }
  }
}

}  // namespace
}  // namespace raysheaf
