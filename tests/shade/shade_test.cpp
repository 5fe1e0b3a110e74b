#include "shade/shade.h"

#include <gtest/gtest.h>

#include "shade/shade_body.h"
#include "support/pictures.h"

namespace raysheaf {
namespace {

using test::Random;

Fragment matte(Vec3 normal, Vec3 incoming) {
  Fragment f;
  f.triangle = 0;
  f.incoming = normalized(incoming);
  f.surface.normal = f.surface.geometric_normal = normalized(normal);
  f.surface.diffuse = {1, 1, 1};
  f.surface.roughness = 1;
  return f;
}

TEST(Shade, LambertUnderAPointLightIsTheTextbookValue) {
  const Fragment f = matte({0, 1, 0}, {0, -1, 0});
  const Vec3 radiance =
      lit_by(f, sample_light(test::point_light({0, 2, 0}, 12), f.surface.position));
  EXPECT_NEAR(radiance.x, 12.0f / 4 / kPi, 1e-6f);
}

TEST(Shade, LightBehindTheSurfaceGivesNothing) {
  const Fragment f = matte({0, 1, 0}, {0, -1, 0});
  EXPECT_EQ(
      max_component(lit_by(f, sample_light(test::point_light({0, -2, 0}, 12), f.surface.position))),
      0);
}

TEST(Shade, NoSurfaceReflectsMoreThanArrives) {
  // Monte Carlo over the hemisphere of directions: albedo at most 1.
  Random random(2);
  for (const float roughness : {0.4f, 0.6f, 1.0f}) {
    for (const float f0 : {0.0f, 0.04f, 0.5f, 1.0f}) {
      for (const float cos_view : {1.0f, 0.5f, 0.1f}) {
        Fragment f = matte({0, 1, 0}, {std::sqrt(1 - cos_view * cos_view), -cos_view, 0});
        f.surface.roughness = roughness;
        f.surface.specular = f.surface.coat = {f0, f0, f0};
        f.surface.diffuse = Vec3{1, 1, 1} * (f0 > 0.5f ? 0.0f : 1.0f);
        double sum = 0;
        constexpr int kSamples = 40000;
        for (int i = 0; i < kSamples; ++i) {
          Vec3 d = random.direction();
          d.y = std::fabs(d.y);
          if (d.y > 0) sum += double{reflectance(f, d).x} * 2 * double{kPi};
        }
        EXPECT_LE(sum / kSamples, 1.03) << roughness << " " << f0 << " " << cos_view;
      }
    }
  }
}

TEST(Shade, EmissionAndSkyAddUp) {
  Fragment f = matte({0, 1, 0}, {0, -1, 0});
  f.surface.emission = {2, 0, 0};
  const Executor executor(1);
  const std::vector<Fragment> fragments{f, Fragment{}};
  const auto radiance = shade_glow(executor, fragments, {0.5f, 0.5f, 0.5f}, {});
  EXPECT_NEAR(radiance[0].x, 2.5f, 1e-6f);
  EXPECT_NEAR(radiance[0].y, 0.5f, 1e-6f);
  EXPECT_EQ(radiance[1].x, 0.5f);  // nothing was met there
}

TEST(Shade, AccumulationIsExactWhateverTheThreads) {
  Random random(4);
  std::vector<Fragment> fragments;
  std::vector<Vec3> radiance;
  std::vector<Vec3> expected(1000);
  for (std::uint32_t pixel = 0; pixel < 1000; ++pixel) {
    for (std::uint32_t i = random.below(4); i > 0; --i) {
      Fragment f;
      f.pixel = pixel;
      f.weight = random.in_box(1);
      fragments.push_back(f);
      radiance.push_back(random.in_box(5));
      expected[pixel] += f.weight * radiance.back();
    }
  }
  for (const std::uint32_t threads : {1u, 2u, 5u}) {
    std::vector<Vec3> pixels(1000);
    accumulate(Executor(threads), fragments, radiance, pixels);
    EXPECT_TRUE(test::same_bits(pixels, expected)) << threads;
  }
}

TEST(Shade, ExposureBringsTheLogarithmicMeanToMiddleGrey) {
  const std::vector<Vec3> pixels(100, {7, 7, 7});
  const std::vector<PixelIds> seen(100, {0, 0, 0});
  EXPECT_NEAR(automatic_exposure(pixels, seen) * 7, 0.18f, 1e-4f);
  EXPECT_EQ(automatic_exposure(pixels, std::vector<PixelIds>(100)), 1);
}

TEST(ToneMap, BlackStaysBlackGreyRisesAndNothingLeavesTheRange) {
  RenderResult result;
  result.width = 256;
  result.height = 1;
  for (int i = 0; i < 256; ++i) {
    const float v = static_cast<float>(i) * 0.05f;
    result.beauty.push_back({v, v, v});
  }
  const Image image = tone_mapped(result);
  EXPECT_EQ(image.rgba[0], 0);
  for (std::size_t i = 4; i < image.rgba.size(); i += 4)
    EXPECT_GE(image.rgba[i], image.rgba[i - 4]);
  EXPECT_GT(image.rgba[255 * 4], 240);
  EXPECT_EQ(image.rgba[3], 255);
}

}  // namespace
}  // namespace raysheaf
