// Small parts of the viewer: adaptive resolution, latencies, layers, lines of bundles.
#include <gtest/gtest.h>

#include <cmath>

#include "bundle_lines.h"
#include "latency.h"
#include "picture.h"
#include "raysheaf/builtin_scenes.h"
#include "resolution.h"
#include "vec.h"

namespace raysheaf::viewer {
namespace {

constexpr Size kWindow{1280, 800};

/// The size at which it settles on a machine that needs `fixed` ms per image and `pixel` ms per
/// pixel.
Size settled(double fixed, double pixel, double goal, Resolution resolution = {}) {
  Size size;
  for (int i = 0; i < 60; ++i) {
    size = resolution.size_for(kWindow, goal);
    resolution.took(size.pixels(), fixed + pixel * static_cast<double>(size.pixels()));
  }
  return size;
}

TEST(Resolution, MeetsItsGoalOnFastAndSlowMachines) {
  for (const double fixed : {0.0, 5.0, 20.0}) {
    for (const double pixel : {1e-5, 1e-4, 1e-3}) {
      const Size size = settled(fixed, pixel, 50);
      const double ms = fixed + pixel * static_cast<double>(size.pixels());
      EXPECT_LT(ms, 60) << fixed << " " << pixel;
      const bool whole = size == kWindow, least = size.width <= 64;
      EXPECT_TRUE(whole || least || ms > 25) << fixed << " " << pixel << " " << ms;
      EXPECT_NEAR(static_cast<double>(size.width) / size.height, 1.6, 0.05);
    }
  }
  EXPECT_EQ(settled(0, 1e-6, 50), kWindow);
  EXPECT_GE(settled(1000, 1, 50).width, 32u);
}

TEST(Resolution, FallsAtOnceAndRisesInSteps) {
  Resolution resolution;
  resolution.took(kWindow.pixels(), 10);
  Size before = resolution.size_for(kWindow, 50);
  for (int i = 0; i < 20; ++i) {
    resolution.took(before.pixels(), 1e-5 * static_cast<double>(before.pixels()));
    const Size now = resolution.size_for(kWindow, 50);
    EXPECT_LE(now.width, std::ceil(before.width * 1.3));
    before = now;
  }
  resolution.took(before.pixels(), 2000);
  EXPECT_LT(resolution.size_for(kWindow, 50).width, before.width / 2);
}

TEST(Resolution, SurvivesEverySize) {
  Resolution resolution;
  EXPECT_EQ(resolution.size_for({0, 0}, 50), (Size{1, 1}));
  resolution.took(0, 5);
  resolution.took(1, -1);
  resolution.took(1, std::nan(""));
  EXPECT_EQ(resolution.expected_ms(1000), 0);
  EXPECT_EQ(resolution.size_for({3, 2}, 50), (Size{3, 2}));
}

TEST(Latency, CountsAndClasses) {
  Latency latency;
  EXPECT_EQ(latency.percentile(0.5), 0);
  for (int i = 100; i >= 1; --i) latency.add(i);
  EXPECT_EQ(latency.percentile(0.5), 50);
  EXPECT_EQ(latency.percentile(0.99), 99);
  EXPECT_EQ(latency.largest(), 100);
  const std::string text = latency.histogram();
  EXPECT_NE(text.find("100 events, median 50.0 ms"), std::string::npos) << text;
  EXPECT_NE(text.find("60 ms+"), std::string::npos) << text;
}

RenderResult small_result() {
  RenderOptions options;
  options.width = 24;
  options.height = 16;
  options.primary = Primary::kTrace;
  options.count_pixel_tests = true;
  return render(builtin_scene("cornell"), options);
}

TEST(Layers, AreAsLargeAsThePictureAndDiffer) {
  const RenderResult result = small_result();
  const TestScale scale = scale_of({&result.tests});
  std::vector<std::vector<std::uint8_t>> seen;
  for (int layer = 0; layer < 6; ++layer) {
    const Image image = layer_image(result, static_cast<Layer>(layer), scale, 1);
    EXPECT_EQ(image.width, 24u);
    EXPECT_EQ(image.rgba.size(), 24u * 16 * 4);
    for (const auto& other : seen) EXPECT_NE(image.rgba, other) << layer;
    seen.push_back(image.rgba);
  }
}

TEST(Layers, ScaleOfTestsHoldsThemAll) {
  const std::vector<float> few = {0, 5, 40}, many = {0, 3, 40000};
  const TestScale linear = scale_of({&few}), logarithmic = scale_of({&few, &many});
  EXPECT_FALSE(linear.logarithmic);
  EXPECT_EQ(linear.at(40), 1);
  EXPECT_TRUE(logarithmic.logarithmic);
  EXPECT_EQ(logarithmic.at(40000), 1);
  EXPECT_EQ(logarithmic.at(0), 0);
  EXPECT_LT(logarithmic.at(3), logarithmic.at(5));
  EXPECT_EQ(scale_of({}).high, 1);
}

TEST(Picking, NamesWhatThePixelShows) {
  SceneDescription scene = builtin_scene("cornell");
  const SceneFacts facts = facts_of(scene);
  RenderResult result = small_result();
  Picture picture;
  picture.request.camera = scene.cameras.front();
  picture.size = {24, 16};
  picture.ids = result.ids;
  picture.position = result.position;
  for (std::uint32_t x = 0; x < 24; ++x) {
    const auto picked = pick(picture, facts, (static_cast<float>(x) + 0.5f) / 24, 0.5f);
    const PixelIds ids = result.ids[8 * 24 + x];
    ASSERT_EQ(picked.has_value(), ids.prim_id != kInvalidId);
    if (!picked) continue;
    EXPECT_EQ(picked->ids.prim_id, ids.prim_id);
    EXPECT_FALSE(picked->mesh.empty());
    EXPECT_FALSE(picked->material.empty());
    const Vec3 eye = column(scene.cameras.front().to_world, 3);
    EXPECT_NEAR(picked->t, length(result.position[8 * 24 + x] - eye), 1e-4f);
  }
  for (const float outside : {-0.1f, 1.0f, std::nanf("")})
    EXPECT_FALSE(pick(picture, facts, outside, 0.5f));
  EXPECT_FALSE(pick(Picture(), facts, 0.5f, 0.5f));
}

TEST(BundleLines, DrawRaysAndBounds) {
  Laboratory laboratory(builtin_scene("cornell"), 24, 24);
  for (const Method method : {Method::kRah, Method::kGl10, Method::kDual}) {
    const auto bundle = laboratory.bundle(LabRays::kReflection1, method_settings(method), 12, 12);
    ASSERT_TRUE(bundle);
    const std::vector<WorldLine> lines = bundle_lines(*bundle, 10);
    int asked = 0, rays = 0, bounds = 0;
    for (const WorldLine& line : lines) {
      EXPECT_TRUE(is_finite(line.from) && is_finite(line.to));
      asked += line.kind == WorldLine::Kind::kAskedRay ? 1 : 0;
      rays += line.kind == WorldLine::Kind::kRay ? 1 : 0;
      bounds += line.kind == WorldLine::Kind::kHull || line.kind == WorldLine::Kind::kCone ? 1 : 0;
    }
    EXPECT_EQ(asked, 1);
    EXPECT_LT(rays, 64);
    EXPECT_EQ(bounds > 0, !bundle->volumes.empty());
  }
}

}  // namespace
}  // namespace raysheaf::viewer
