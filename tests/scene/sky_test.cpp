// The sun's position against published examples, and what the sky must be.
#include "raysheaf/studio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/vec.h"
#include "raysheaf/error.h"

namespace raysheaf::test {
namespace {

constexpr double kSkyDegrees = 180 / std::numbers::pi;

// I. Reda, A. Andreas, "Solar Position Algorithm for Solar Radiation Applications", NREL 2004,
// table A5.1: 2003-10-17 19:30:30 UTC at 39.742476 north, 105.1786 west; the elevation there is
// 39.872 degrees without refraction, the azimuth 194.340.
TEST(Sky, TheSunStandsWhereNrelComputesIt) {
  const SunPosition sun = sun_position(39.742476, -105.1786, 1066419030);
  EXPECT_NEAR(sun.elevation * kSkyDegrees, 39.872046, 0.02);
  EXPECT_NEAR(sun.azimuth * kSkyDegrees, 194.34024, 0.02);
}

// Meeus, example 25.a: at 1992-10-13 00:00 the declination is -7.78507 degrees. Seen from the north
// pole, that is the elevation.
TEST(Sky, TheDeclinationIsMeeuss) {
  EXPECT_NEAR(sun_position(90, 0, 718934400).elevation * kSkyDegrees, -7.78507, 0.003);
}

// At the equinox of 2024 (March 20, 03:06 UTC, Astronomical Almanac) the declination is 0.
TEST(Sky, TheSunIsOverTheEquatorAtTheEquinox) {
  EXPECT_NEAR(sun_position(90, 0, 1710903960).elevation * kSkyDegrees, 0, 0.01);
}

TEST(Sky, NorthIsBehindTheFrontOfTheModel) {
  const SunPosition north{0, 0}, east{0, std::numbers::pi / 2}, high{std::numbers::pi / 2, 0};
  const auto near_to = [](Vec3 a, Vec3 b) { return length(a - b) < 1e-6f; };
  EXPECT_TRUE(near_to(sun_direction(north, UpAxis::kY), {0, 0, -1}));
  EXPECT_TRUE(near_to(sun_direction(east, UpAxis::kY), {1, 0, 0}));
  EXPECT_TRUE(near_to(sun_direction(north, UpAxis::kZ), {0, 1, 0}));
  EXPECT_TRUE(near_to(sun_direction(east, UpAxis::kZ), {1, 0, 0}));
  for (const UpAxis up :
       {UpAxis::kX, UpAxis::kY, UpAxis::kZ, UpAxis::kMinusX, UpAxis::kMinusY, UpAxis::kMinusZ})
    EXPECT_TRUE(near_to(sun_direction(high, up), direction_of(up)));
}

// The paper's figure 5: the sky is brightest around the sun, blue away from it; a low sun is red.
TEST(Sky, IsBlueAndBrightestNearTheSun) {
  for (const UpAxis up : {UpAxis::kY, UpAxis::kZ, UpAxis::kMinusX}) {
    SceneDescription scene;
    const Vec3 to_sun = sun_direction({0.7, 1.0}, up);
    add_sun_and_sky(scene, to_sun * 5, up);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_LT(length(scene.lights[0].direction + to_sun), 1e-6f);
    const Environment& map = scene.environment;
    float most = 0;
    Vec3 brightest, opposite;
    for (std::uint32_t y = 0; y < map.height; ++y) {
      for (std::uint32_t x = 0; x < map.width; ++x) {
        const Vec3 radiance = map.radiance[std::size_t{y} * map.width + x];
        EXPECT_TRUE(is_finite(radiance) && min_component(radiance) >= 0);
        const double polar = std::numbers::pi * (y + 0.5) / map.height;
        const double turn = 2 * std::numbers::pi * ((x + 0.5) / map.width - 0.5);
        const Vec3 d{static_cast<float>(std::sin(polar) * std::sin(turn)),
                     static_cast<float>(std::cos(polar)),
                     static_cast<float>(-std::sin(polar) * std::cos(turn))};
        if (radiance.y > most) most = radiance.y, brightest = d;
        if (length(d - normalized(direction_of(up) - to_sun * 0.3f)) < 0.02f) opposite = radiance;
      }
    }
    EXPECT_LT(length(brightest - to_sun), 0.05f);
    EXPECT_GT(opposite.z, 1.3f * opposite.x);
    const Vec3 direct = scene.lights[0].intensity;
    EXPECT_GT(direct.y, 60);  // klx; a clear day has about 100 with the sun overhead
    EXPECT_LT(direct.y, 128);
  }
  SceneDescription high, low;
  add_sun_and_sky(high, {0, 1, 0}, UpAxis::kY);
  add_sun_and_sky(low, {0, 0.05f, 1}, UpAxis::kY);
  const Vec3 noon = high.lights[0].intensity, dusk = low.lights[0].intensity;
  EXPECT_GT(dusk.x / dusk.z, 2 * noon.x / noon.z);
}

TEST(Sky, NeedsADirectionAboveTheHorizon) {
  SceneDescription scene;
  EXPECT_THROW(add_sun_and_sky(scene, {0, 0, 0}, UpAxis::kY), Error);
  EXPECT_THROW(add_sun_and_sky(scene, {0, -1, 1}, UpAxis::kY), Error);
  EXPECT_THROW(add_sun_and_sky(scene, {0, NAN, 1}, UpAxis::kY), Error);
  EXPECT_TRUE(scene.lights.empty() && scene.environment.empty());
}

}  // namespace
}  // namespace raysheaf::test
