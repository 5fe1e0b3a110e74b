// The numbers that samples use: stratification, seeds, the pixel filter.
#include "render/rays/sample_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "render/rays/filter.h"

namespace raysheaf {
namespace {

/// Sobol's second dimension from its direction numbers, as defined in the papers.
std::uint32_t sobol_by_directions(std::uint32_t index) {
  std::uint32_t bits = 0, direction = 1u << 31;
  for (; index != 0; index >>= 1, direction ^= direction >> 1)
    if ((index & 1) != 0) bits ^= direction;
  return bits;
}

TEST(Sample, TheSecondDimensionIsSobols) {
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const std::uint32_t index = i < 2500 ? i : i * 0x9e3779b9u;
    ASSERT_EQ(sobol_second(index), sobol_by_directions(index)) << index;
  }
}

TEST(Sample, ScramblingIsABijectionOfEachStratum) {
  for (const std::uint32_t seed : {0u, 1u, 77u, 0xffffffffu}) {
    std::set<std::uint32_t> seen;
    for (std::uint32_t i = 0; i < 256; ++i) {
      seen.insert(owen_scrambled(i << 24, seed) >> 24);
      // Lower bits do not leave the image of their stratum.
      EXPECT_EQ(owen_scrambled(i << 24, seed) >> 24, owen_scrambled((i << 24) | 12345, seed) >> 24);
    }
    EXPECT_EQ(seen.size(), 256u);
  }
}

/// Every successive 2^k points have one in each elementary interval: 2^a columns, 2^(k - a) rows.
TEST(Sample, EverySeedGivesAZeroTwoSequence) {
  for (const std::uint32_t seed : {0u, 5u, 1234567u}) {
    for (const int k : {1, 4, 7}) {
      const std::uint32_t count = 1u << k;
      for (const std::uint32_t first : {0u, count, 6 * count}) {
        for (int a = 0; a <= k; ++a) {
          std::set<std::uint32_t> cells;
          for (std::uint32_t i = 0; i < count; ++i) {
            const FractionPair p = scrambled_sobol(first + i, seed);
            const std::uint32_t column = a == 0 ? 0 : p.x >> (32 - a);
            const std::uint32_t row = a == k ? 0 : p.y >> (32 - (k - a));
            cells.insert(column * count + row);
          }
          EXPECT_EQ(cells.size(), count) << "seed " << seed << " k " << k << " a " << a;
        }
      }
    }
  }
}

TEST(Sample, IntegratesBetterThanRandomPoints) {
  // The area of a quarter disc with 256 points: random points have a standard deviation of 0.026.
  double worst = 0;
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    int inside = 0;
    for (std::uint32_t i = 0; i < 256; ++i) {
      const Vec2 p = sample_pair({i, 256}, seed);
      inside += p.x * p.x + p.y * p.y < 1 ? 1 : 0;
    }
    worst = std::max(worst, std::fabs(inside / 256.0 - 0.785398));
  }
  EXPECT_LT(worst, 0.02);
}

TEST(Sample, SeedsOfNeighboursAreUnrelated) {
  // The mean of the first sample over many pixels: a standard deviation of 0.289 / 64.
  for (const Choice choice : {Choice::kLens, Choice::kLight}) {
    double x = 0, y = 0, xy = 0;
    for (std::uint32_t pixel = 0; pixel < 4096; ++pixel) {
      const Vec2 p = sample_pair({0, 2}, choice_seed(choice, pixel, 1, 0));
      x += p.x / 4096.0;
      y += p.y / 4096.0;
      xy += p.x * p.y / 4096.0;
    }
    EXPECT_NEAR(x, 0.5, 0.02);
    EXPECT_NEAR(y, 0.5, 0.02);
    EXPECT_NEAR(xy, 0.25, 0.02);
  }
}

TEST(Sample, OneSampleIsTheMiddle) {
  EXPECT_EQ(sample_pair({0, 1}, 99).x, 0.5f);
  EXPECT_EQ(sample_pair({0, 1}, 99).y, 0.5f);
}

TEST(Filter, TheFirstSampleIsThePixelsCentreWhateverTheirNumber) {
  for (const std::uint32_t count : {1u, 2u, 65536u}) {
    EXPECT_EQ(filter_offset({0, count}).x, 0);
    EXPECT_EQ(filter_offset({0, count}).y, 0);
  }
}

TEST(Filter, SamplesAreSpreadAsTheGaussianFalls) {
  constexpr std::uint32_t kSamples = 4096;
  double mean_x = 0, mean_y = 0, square = 0;
  int within = 0;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const Vec2 p = filter_offset({i, kSamples});
    const double r = std::hypot(p.x, p.y);
    EXPECT_LE(r, kFilterRadius * 1.0001);
    mean_x += p.x / double{kSamples};
    mean_y += p.y / double{kSamples};
    square += r * r / kSamples;
    within += r < 0.5 ? 1 : 0;
  }
  EXPECT_NEAR(mean_x, 0, 2e-3);
  EXPECT_NEAR(mean_y, 0, 2e-3);
  // The variance of a Gaussian truncated at c deviations: 2 s^2 (1 - (c^2 / 2) e / (1 - e)), e =
  // exp(-c^2 / 2).
  const double e = std::exp(-4.5);
  EXPECT_NEAR(square, 2 * 0.25 * (1 - 4.5 * e / (1 - e)), 2e-3);
  EXPECT_NEAR(within / double{kSamples}, (1 - std::exp(-0.5)) / (1 - e), 2e-3);
}

}  // namespace
}  // namespace raysheaf
