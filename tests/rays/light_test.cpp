// Lights with a size agree with closed forms, and with point lights at a large distance.
#include "render/rays/light_body.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "support/lambert.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kCount = 4096;

/// The irradiance on a surface with this normal, estimated by samples.
double mean_irradiance(const Light& light, Vec3 position, Vec3 normal) {
  double sum = 0;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const LightSample s = sample_light(placed_light(light), position, sample_pair({i, kCount}, 7));
    sum += std::fmax(
        0.0, static_cast<double>(dot(s.to_light, normal)) * static_cast<double>(s.irradiance.x));
  }
  return sum / kCount;
}

Light ball(Vec3 center, float radius, float intensity) {
  Light light;
  light.position = center;
  light.radius = radius;
  light.intensity = {intensity, intensity, intensity};
  return light;
}

TEST(BallLight, AboveTheHorizonItEqualsAPointLight) {
  // pi L (r / d)^2 cos, with L = I / (pi r^2): the radius cancels.
  for (const float radius : {1e-4f, 0.5f, 1.9f}) {
    for (const Vec3 center : {Vec3{0, 2, 0}, Vec3{0.3f, 4, -2}}) {
      const double d2 = static_cast<double>(dot(center, center));
      const double expected = 30 * static_cast<double>(center.y) / (d2 * std::sqrt(d2));
      EXPECT_NEAR(mean_irradiance(ball(center, radius, 30), {0, 0, 0}, {0, 1, 0}), expected,
                  2e-3 * expected)
          << radius;
    }
  }
}

TEST(BallLight, HalfBelowTheHorizonItGivesHalfOfItsDisc) {
  // Seen at the height of its centre, the upper half of a disc with sine s gives E = L int int cos
  // dw, integrated numerically.
  const Light light = ball({5, 0, 0}, 2, 10);
  const double sine = 2.0 / 5, radiance = 10 / (3.14159265 * 4);
  double expected = 0;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double theta = std::asin(sine) * (i + 0.5) / kSteps;
      const double phi = 3.14159265 * (j + 0.5) / kSteps;
      expected += radiance * std::sin(theta) * std::sin(phi) * std::sin(theta);
    }
  }
  expected *= std::asin(sine) / kSteps * 3.14159265 / kSteps;
  EXPECT_NEAR(mean_irradiance(light, {0, 0, 0}, {0, 1, 0}), expected, 5e-3 * expected);
}

TEST(BallLight, EmitsFromItsSurfaceAndNotInside) {
  const Light light = ball({1, 2, 3}, 0.5f, 10);
  for (std::uint32_t i = 0; i < 256; ++i) {
    const LightSample s = sample_light(placed_light(light), {4, -1, 2}, sample_pair({i, 256}, 3));
    EXPECT_NEAR(length(s.point - light.position), 0.5f, 1e-4f);
    EXPECT_LT(dot(s.point - light.position, s.to_light), 1e-4f);  // on the near side
    EXPECT_NEAR(length(s.to_light), 1, 1e-5f);
  }
  EXPECT_EQ(max_component(sample_light(placed_light(light), {1.1f, 2, 3}, {0.3f, 0.3f}).irradiance),
            0);
  EXPECT_EQ(
      max_component(sample_light(placed_light(light), light.position, {0.3f, 0.3f}).irradiance), 0);
}

Light rectangle(Vec3 center, Vec3 direction, Vec3 right, float width, float height) {
  Light light;
  light.type = Light::Type::kRectangle;
  light.position = center;
  light.direction = direction;
  light.right = right;
  light.width = width;
  light.height = height;
  light.intensity = {12, 12, 12};
  return light;
}

TEST(RectangleLight, GivesLambertsFormula) {
  for (const Vec3 position : {Vec3{0, 0, 0}, Vec3{1.5f, 0, -0.7f}, Vec3{-4, 0, 9}}) {
    for (const auto& [width, height] : {std::pair{2.0f, 1.0f}, {0.1f, 3.0f}, {8.0f, 8.0f}}) {
      const Light light = rectangle({0.2f, 2, 0.3f}, {0, -1, 0}, {1, 0, 0}, width, height);
      const double expected = test::lambert(light, position, {0, 1, 0});
      EXPECT_NEAR(mean_irradiance(light, position, {0, 1, 0}), expected, 3e-3 * expected)
          << width << " " << position.x;
    }
  }
  const Vec3 slanted = normalized({0.3f, -1, 0.2f});
  const Light light =
      rectangle({0, 3, 0}, slanted, normalized(cross(slanted, {0, 0, 1})), 1.5f, 0.5f);
  const Vec3 normal = normalized({0.2f, 1, -0.1f});
  const double expected = test::lambert(light, {0.4f, 0, 0.1f}, normal);
  EXPECT_NEAR(mean_irradiance(light, {0.4f, 0, 0.1f}, normal), expected, 3e-3 * expected);
}

TEST(RectangleLight, EveryPartOfItsSolidAngleIsChosenAsOften) {
  // The fraction of samples on the left half of the rectangle equals its fraction of the solid
  // angle.
  const SeenRectangle all{-0.5, -1, 2.5, 0.3, -0.8}, left{-0.5, -1, 1, 0.3, -0.8};
  const double expected = place_by_solid_angle(left, {0, 0}).solid_angle /
                          place_by_solid_angle(all, {0, 0}).solid_angle;
  int within = 0, lower = 0;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const RectanglePlace place = place_by_solid_angle(all, sample_pair({i, kCount}, 11));
    EXPECT_GE(place.x, all.x0);
    EXPECT_LE(place.x, all.x1);
    EXPECT_GE(place.y, all.y0);
    EXPECT_LE(place.y, all.y1);
    within += place.x < 1 ? 1 : 0;
    lower += place.y < -0.2 ? 1 : 0;
  }
  const SeenRectangle bottom{-0.5, -1, 2.5, -0.2, -0.8};
  EXPECT_NEAR(within / double{kCount}, expected, 2e-3);
  EXPECT_NEAR(lower / double{kCount},
              place_by_solid_angle(bottom, {0, 0}).solid_angle /
                  place_by_solid_angle(all, {0, 0}).solid_angle,
              2e-3);
  // A face of a cube around the eye covers a sixth of the sphere.
  EXPECT_NEAR(place_by_solid_angle({-1, -1, 1, 1, -1}, {0, 0}).solid_angle,
              4 * 3.14159265358979 / 6, 1e-12);
}

TEST(RectangleLight, IsAPointFromAfarAndContinuousWhereTheMethodChanges) {
  for (const float distance : {10.0f, 900.0f, 1100.0f, 1e5f}) {
    const Light light = rectangle({0, distance, 0}, {0, -1, 0}, {1, 0, 0}, 1, 1);
    const double expected = 12 / (static_cast<double>(distance) * static_cast<double>(distance));
    EXPECT_NEAR(mean_irradiance(light, {0, 0, 0}, {0, 1, 0}), expected, 8e-3 * expected)
        << distance;
  }
}

TEST(RectangleLight, ShinesToOneSideAndFromItsOwnPlane) {
  const Light light = rectangle({0, 2, 0}, {0, -1, 0}, {1, 0, 0}, 2, 1);
  EXPECT_EQ(max_component(sample_light(placed_light(light), {0, 3, 0}, {0.2f, 0.7f}).irradiance),
            0);
  EXPECT_EQ(max_component(sample_light(placed_light(light), {5, 2, 0}, {0.2f, 0.7f}).irradiance),
            0);
  for (std::uint32_t i = 0; i < 64; ++i) {
    const LightSample s =
        sample_light(placed_light(light), {0.3f, 1.999f, 0.2f}, sample_pair({i, 64}, 3));
    EXPECT_LE(std::fabs(s.point.x), 1.0001f);
    EXPECT_LE(std::fabs(s.point.z), 0.5001f);
    // Slightly in front of the light, so that the lamp's own glass does not shadow it.
    EXPECT_LT(s.point.y, 2);
    EXPECT_GT(s.point.y, 1.9999f);
    EXPECT_TRUE(is_finite(s.irradiance));
  }
}

TEST(Lights, ScaleWithTheScene) {
  for (const float scale : {1e-3f, 1e3f}) {
    Light light = ball({1, 2, 3}, 0.5f, 10);
    const LightSample plain = sample_light(placed_light(light), {4, -1, 2}, {0.3f, 0.8f});
    light.position *= scale;
    light.radius *= scale;
    light.intensity *= scale * scale;
    const LightSample scaled =
        sample_light(placed_light(light), Vec3{4, -1, 2} * scale, {0.3f, 0.8f});
    EXPECT_NEAR(scaled.irradiance.x, plain.irradiance.x, 1e-5f * plain.irradiance.x);
    EXPECT_NEAR(scaled.distance, plain.distance * scale, 1e-5f * plain.distance * scale);
  }
}

}  // namespace
}  // namespace raysheaf
