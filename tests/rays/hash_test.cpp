#include "render/rays/hash_body.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <vector>

#include "support/random.h"

namespace raysheaf {
namespace {

using test::Random;

TEST(Hash, HilbertVisitsEveryCellOnceAndStepsToNeighbours) {
  for (const std::uint32_t bits : {1u, 2u, 5u, 8u}) {
    const std::uint32_t side = 1u << bits;
    std::vector<std::pair<int, int>> path(side * side, {-1, -1});
    for (std::uint32_t x = 0; x < side; ++x) {
      for (std::uint32_t y = 0; y < side; ++y) {
        const std::uint32_t place = hilbert_2(x, y, bits);
        ASSERT_LT(place, path.size());
        ASSERT_EQ(path[place].first, -1);
        path[place] = {static_cast<int>(x), static_cast<int>(y)};
      }
    }
    for (std::size_t i = 1; i < path.size(); ++i) {
      const int step = std::abs(path[i].first - path[i - 1].first) +
                       std::abs(path[i].second - path[i - 1].second);
      ASSERT_EQ(step, 1) << "bits " << bits << " place " << i;
    }
  }
}

TEST(Hash, OctahedralMapStaysInTheSquareAndTellsDirectionsApart) {
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const Vec3 a = random.direction(), b = random.direction_near(a, 1e-2f);
    const Vec2 p = octahedral(a), q = octahedral(b * random.between(1e-3f, 1e3f));
    ASSERT_GE(p.x, 0) << i;
    ASSERT_LE(p.x, 1) << i;
    ASSERT_GE(p.y, 0) << i;
    ASSERT_LE(p.y, 1) << i;
    const Vec2 opposite = octahedral(-a);
    EXPECT_GT(std::fabs(p.x - opposite.x) + std::fabs(p.y - opposite.y), 0.3f);
    // Neighbours stay neighbours, except across the folded border of the lower hemisphere.
    if (a.z > 0.05f && b.z > 0.05f) {
      EXPECT_LT(std::fabs(p.x - q.x) + std::fabs(p.y - q.y), 0.05f);
    }
  }
}

TEST(Hash, ShadowKeysKeepTheLightAboveTheDirection) {
  for (const std::uint32_t lights : {1u, 2u, 3u, 17u, 1000u, 1u << 20}) {
    const ShadowKeyLayout layout = shadow_key_layout(lights);
    EXPECT_LE(layout.key_bits(), 32u);
    Random random(lights);
    for (int i = 0; i < 1000; ++i) {
      const std::uint32_t a = random.below(lights), b = random.below(lights);
      const std::uint32_t key_a = shadow_key(layout, a, {random.unit(), random.unit()});
      const std::uint32_t key_b = shadow_key(layout, b, {random.unit(), random.unit()});
      if (a < b) {
        EXPECT_LT(key_a, key_b);
      }
      if (layout.key_bits() < 32) {
        EXPECT_EQ(key_a >> layout.key_bits(), 0u);
      }
    }
  }
}

TEST(Hash, BounceKeysHaveThirtyBitsAndFollowBothOriginAndDirection) {
  const Box box{{-1, -2, -3}, {1, 2, 3}};
  Random random(3);
  std::set<std::uint32_t> keys;
  for (int i = 0; i < 5000; ++i) {
    const std::uint32_t key = bounce_key(box, random.in_box(3), random.direction());
    EXPECT_EQ(key >> kBounceKeyBits, 0u);
    keys.insert(key);
  }
  EXPECT_GT(keys.size(), 4000u);
  const Vec3 d{0, 0, 1};
  EXPECT_NE(bounce_key(box, {-1, 0, 0}, d), bounce_key(box, {1, 0, 0}, d));
  EXPECT_NE(bounce_key(box, {0, 0, 0}, d), bounce_key(box, {0, 0, 0}, -d));
}

TEST(Hash, FlatAndEmptyBoxesAreLegal) {
  const Box flat{{0, 1, 0}, {4, 1, 4}};
  EXPECT_EQ(bounce_key(flat, {1, 1, 1}, {0, 1, 0}), bounce_key(flat, {1, 5, 1}, {0, 1, 0}));
  EXPECT_EQ(quantized(-3, 6), 0u);
  EXPECT_EQ(quantized(7, 6), 63u);
  EXPECT_EQ(quantized(std::numeric_limits<float>::quiet_NaN(), 6), 0u);
}

}  // namespace
}  // namespace raysheaf
