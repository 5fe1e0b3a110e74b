// Environments: the map's texel for each direction, and importance sampling.
#include "render/surface/environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "exec/executor.h"
#include "render/rays/sample_body.h"

namespace raysheaf {
namespace {

Environment random_map(std::uint32_t width, std::uint32_t height, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  Environment map;
  map.width = width;
  map.height = height;
  for (std::uint32_t i = 0; i < width * height; ++i) {
    const float value = unit(random) < 0.7f ? 0 : unit(random);
    map.radiance.push_back({value, value * 0.5f, value * unit(random)});
  }
  map.radiance[width * height / 3] = {200, 190, 150};  // a sun
  return map;
}

/// Uniformly distributed over the sphere.
Vec3 even_direction(Vec2 chosen) {
  const float z = 1 - 2 * chosen.x, ring = std::sqrt(std::fmax(0.0f, 1 - z * z));
  return {ring * std::cos(6.2831853f * chosen.y), z, ring * std::sin(6.2831853f * chosen.y)};
}

TEST(Environment, TheMiddleIsStraightAheadAndColumnsGoToTheRight) {
  Environment map;
  map.width = 4;
  map.height = 3;
  for (std::uint32_t i = 0; i < 12; ++i) map.radiance.push_back({static_cast<float>(i), 0, 0});
  const auto seen = [&](Vec3 direction) {
    return environment_radiance(EnvironmentMap(Executor(1), map).view(), direction).x;
  };
  // Texel centres of the middle row (4 to 7) lie at -135, -45, 45 and 135 degrees.
  const float r = std::sqrt(0.5f);
  EXPECT_NEAR(seen({-r, 0, r}), 4, 1e-4f);
  EXPECT_NEAR(seen({-r, 0, -r}), 5, 1e-4f);
  EXPECT_NEAR(seen({r, 0, -r}), 6, 1e-4f);
  EXPECT_NEAR(seen({r, 0, r}), 7, 1e-4f);
  EXPECT_NEAR(seen({0, 0, -1}), 5.5f, 1e-4f);  // between two texels
  EXPECT_NEAR(seen({0, 0, 1}), 5.5f, 1e-4f);   // across the seam: 7 and 4
  EXPECT_LT(seen({0, 1, 0}), 4);               // up is the first row
  EXPECT_GT(seen({0, -1, 0}), 7);
  map.rotation = 1.57079633f;  // a quarter turn to the left, seen from above: ahead is now left
  EXPECT_NEAR(seen({-r, 0, -r}), 6, 1e-4f);
  map.intensity = 3;
  EXPECT_NEAR(seen({-r, 0, -r}), 18, 1e-3f);
}

TEST(Environment, DirectionsAndPlacesAreEachOthersInverse) {
  Environment map = random_map(8, 4, 1);
  map.rotation = 0.7f;
  const EnvironmentMap made(Executor(1), map);
  for (std::uint32_t i = 0; i < 200; ++i) {
    const Vec3 d = even_direction(sample_pair({i, 200}, 5));
    const Vec3 back = map_direction(made.view(), map_place(made.view(), d));
    EXPECT_NEAR(length(back - d), 0, 2e-6f);
  }
}

TEST(Environment, TheDensityIsOneOverTheSphereAndThatOfWhatIsChosen) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, {7u, 5u}, {64u, 32u}}) {
    const Environment map = random_map(width, height, 3);
    const EnvironmentMap made(Executor(2), map);
    constexpr std::uint32_t kCount = 1u << 16;
    double sum = 0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const float density = direction_density(made.view(), even_direction(sample_pair({i, 2}, 9)));
      sum += static_cast<double>(density) * 4 * 3.14159265358979 / kCount;
    }
    EXPECT_NEAR(sum, 1, 0.02) << width;
    std::uint32_t agree = 0;
    for (std::uint32_t i = 0; i < 1000; ++i) {
      const ChosenDirection chosen = choose_direction(made.view(), sample_pair({i, 2}, 21));
      EXPECT_GT(chosen.density, 0);
      EXPECT_NEAR(length(chosen.direction), 1, 1e-5f);
      const float again = direction_density(made.view(), chosen.direction);
      agree += std::fabs(again - chosen.density) <= 1e-3f * chosen.density ? 1 : 0;
    }
    EXPECT_GE(agree, 995u);  // all except those on a border between texels
  }
}

TEST(Environment, ChoosingByBrightnessGivesTheEnergyThatEvenChoosingGives) {
  const Environment map = random_map(32, 16, 4);
  const EnvironmentMap made(Executor(2), map);
  const Vec3 normal = normalized({0.3f, 1, 0.2f});
  double even = 0, chosen = 0, chosen_square = 0;
  constexpr std::uint32_t kEven = 1u << 18, kChosen = 1u << 12;
  for (std::uint32_t i = 0; i < kEven; ++i) {
    const Vec3 d = even_direction(sample_pair({i, 2}, 1));
    even += std::fmax(0.0, static_cast<double>(dot(d, normal))) *
            static_cast<double>(environment_radiance(made.view(), d).x) * 4 * 3.14159265 / kEven;
  }
  for (std::uint32_t i = 0; i < kChosen; ++i) {
    const ChosenDirection c = choose_direction(made.view(), sample_pair({i, 2}, 2));
    const double value =
        std::fmax(0.0, static_cast<double>(dot(c.direction, normal))) *
        static_cast<double>(environment_radiance(made.view(), c.direction).x / c.density);
    chosen += value / kChosen;
    chosen_square += value * value / kChosen;
  }
  EXPECT_NEAR(chosen, even, 0.02 * even);
  // A sun of 200 in a sky of a seventh: uniform sampling has a standard deviation of many times the
  // mean.
  EXPECT_LT(std::sqrt(chosen_square - chosen * chosen), 2 * chosen);
}

TEST(Environment, BlackIsNeverChosenAndHasNoDensity) {
  Environment map;
  map.width = 4;
  map.height = 2;
  map.radiance.resize(8);
  const EnvironmentMap made(Executor(1), map);
  EXPECT_EQ(direction_density(made.view(), {0, 1, 0}), 0);
  EXPECT_EQ(choose_direction(made.view(), {0.5f, 0.5f}).density, 0);
  EXPECT_EQ(environment_radiance(made.view(), {0, 1, 0}).x, 0);
}

}  // namespace
}  // namespace raysheaf
