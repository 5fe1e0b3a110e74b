#include "paper/order/keys.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "paper/order/key_body.h"
#include "paper/order/published_body.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"
#include "support/pictures.h"
#include "support/random.h"

namespace raysheaf {
namespace {

using test::Random;

/// The cell with this number, below 2^(bits * kDimensions).
template <int kDimensions>
Cell<kDimensions> numbered_cell(std::uint64_t number, std::uint32_t bits) {
  Cell<kDimensions> cell{};
  for (int i = 0; i < kDimensions; ++i) {
    cell.axis[i] = static_cast<std::uint32_t>(number) & ((1u << bits) - 1);
    number >>= bits;
  }
  return cell;
}

template <int kDimensions>
std::uint32_t steps_between(const Cell<kDimensions>& a, const Cell<kDimensions>& b) {
  std::uint32_t steps = 0;
  for (int i = 0; i < kDimensions; ++i)
    steps += a.axis[i] < b.axis[i] ? b.axis[i] - a.axis[i] : a.axis[i] - b.axis[i];
  return steps;
}

/// Every cell has a different position, and successive positions are adjacent cells.
template <int kDimensions>
void check_hilbert(std::uint32_t bits) {
  const std::uint64_t cells = std::uint64_t{1} << (bits * kDimensions);
  std::vector<Cell<kDimensions>> path(cells);
  std::vector<int> visits(cells);
  for (std::uint64_t i = 0; i < cells; ++i) {
    const auto cell = numbered_cell<kDimensions>(i, bits);
    const std::uint64_t place = hilbert_place(cell, bits);
    ASSERT_LT(place, cells);
    path[place] = cell;
    ++visits[place];
  }
  for (std::uint64_t i = 0; i < cells; ++i) {
    ASSERT_EQ(visits[i], 1) << kDimensions << " dimensions, " << bits << " bits, place " << i;
    if (i > 0) {
      ASSERT_EQ(steps_between(path[i - 1], path[i]), 1u)
          << kDimensions << " dimensions, " << bits << " bits, place " << i;
    }
  }
}

TEST(Curves, HilbertVisitsEveryCellOnceAndStepsToNeighbours) {
  for (const std::uint32_t bits : {0u, 1u, 2u, 3u, 8u}) check_hilbert<2>(bits);
  for (const std::uint32_t bits : {0u, 1u, 2u, 5u}) check_hilbert<3>(bits);
  for (const std::uint32_t bits : {0u, 1u, 2u, 4u}) check_hilbert<4>(bits);
  for (const std::uint32_t bits : {0u, 1u, 2u, 3u}) check_hilbert<5>(bits);
  for (const std::uint32_t bits : {0u, 1u, 2u, 3u}) check_hilbert<6>(bits);
}

/// Computes the code bit by bit, from the highest.
template <int kDimensions>
std::uint64_t naive_morton(const Cell<kDimensions>& cell) {
  std::uint64_t place = 0;
  for (std::uint32_t bit = kMostCellBits<kDimensions>; bit-- > 0;)
    for (int i = 0; i < kDimensions; ++i) place = (place << 1) | ((cell.axis[i] >> bit) & 1u);
  return place;
}

template <int kDimensions>
void check_morton(Random* random) {
  const std::uint32_t drop = 32 - kMostCellBits<kDimensions>;
  for (int n = 0; n < 2000; ++n) {
    Cell<kDimensions> cell{};
    for (std::uint32_t& x : cell.axis) x = random->bits() >> drop;
    ASSERT_EQ(morton_place(cell), naive_morton(cell)) << kDimensions;
  }
}

TEST(Curves, MortonInterleavesTheBits) {
  Random random(2);
  check_morton<2>(&random);
  check_morton<3>(&random);
  check_morton<4>(&random);
  check_morton<5>(&random);
  check_morton<6>(&random);
}

struct KeyedRays {
  RayBatch batch;
  Box box{{-1, -2, -3}, {4, 2, 1}};
};

/// Rays of all kinds: inside and outside of the box, along its axes, of any length.
KeyedRays random_rays(RayKind kind, std::uint32_t lights, std::uint64_t seed) {
  constexpr std::uint32_t kEach = 300;
  KeyedRays bundle;
  RayBatch& batch = bundle.batch;
  batch.kind = kind;
  batch.width = 20;
  Random random(seed);
  for (std::uint32_t light = 0; light < lights; ++light) {
    for (std::uint32_t i = 0; i < kEach; ++i) {
      Ray ray;
      ray.origin = random.in_box(i % 5 == 0 ? 20.0f : 1.0f);
      ray.direction = random.direction() * std::exp(random.between(-5, 5));
      if (i % 7 == 0) ray.direction = {0, 0, i % 2 == 0 ? 1.0f : -1.0f};
      if (kind == RayKind::kShadow) ray.t_max = 1;
      batch.rays.push_back(ray);
      batch.pixels.push_back(i);
      batch.slots.push_back(light * kEach + i);
      batch.keys.push_back(random.bits() >> 2);
      if (kind == RayKind::kShadow) batch.lights.push_back(light + 3);
    }
  }
  batch.key_bits = 30;
  return bundle;
}

TEST(Keys, FitTheBitsTheyUse) {
  const Executor executor(2);
  for (const RayKind kind : {RayKind::kShadow, RayKind::kReflection, RayKind::kRefraction}) {
    for (const std::uint32_t lights : {1u, 2u, 37u}) {
      const KeyedRays b = random_rays(kind, lights, lights);
      for (const RayKeyEntry& entry : kRayKeys) {
        const RayKey key = entry.key;
        for (const std::uint32_t bits : {32u, 64u}) {
          std::uint32_t used = 99;
          const auto keys = make_keys(executor, b.batch, key, bits, b.box, &used);
          ASSERT_EQ(keys.size(), b.batch.rays.size());
          ASSERT_LE(used, bits) << to_string(key);
          for (const std::uint64_t k : keys) {
            if (used < 64) {
              ASSERT_EQ(k >> used, 0u) << to_string(key) << " " << bits;
            }
          }
          if (key == RayKey::kRaster) {
            EXPECT_EQ(used, 0u);
          } else {
            EXPECT_GT(std::set<std::uint64_t>(keys.begin(), keys.end()).size(), 10u)
                << to_string(key) << " " << bits;
          }
        }
      }
    }
  }
}

TEST(Keys, SixtyFourBitsTellMoreRaysApart) {
  const Executor executor(2);
  const KeyedRays b = random_rays(RayKind::kShadow, 37, 5);
  for (const RayKeyEntry& entry : kRayKeys) {
    const RayKey key = entry.key;
    if (entry.axes == 0 || entry.cell == KeyCell::kPixel) continue;
    std::uint32_t low = 0, high = 0;
    const auto coarse = make_keys(executor, b.batch, key, 32, b.box, &low);
    const auto fine = make_keys(executor, b.batch, key, 64, b.box, &high);
    EXPECT_GT(high, low) << to_string(key);
    EXPECT_GE(std::set<std::uint64_t>(fine.begin(), fine.end()).size(),
              std::set<std::uint64_t>(coarse.begin(), coarse.end()).size())
        << to_string(key);
  }
}

TEST(Keys, KeepTheLightAboveEverythingElse) {
  const Executor executor(2);
  const KeyedRays b = random_rays(RayKind::kShadow, 37, 6);
  for (const RayKeyEntry& entry : kRayKeys) {
    const RayKey key = entry.key;
    if (entry.axes == 0) continue;
    for (const std::uint32_t bits : {32u, 64u}) {
      std::uint32_t used = 0;
      const auto keys = make_keys(executor, b.batch, key, bits, b.box, &used);
      for (std::size_t i = 300; i < keys.size(); ++i)
        // Key i - 300 belongs to the previous light.
        ASSERT_LT(keys[i - 300], keys[i]) << to_string(key) << " " << bits;
    }
  }
}

TEST(Keys, DoNotDependOnTheNumberOfThreads) {
  for (const RayKind kind : {RayKind::kShadow, RayKind::kReflection}) {
    const KeyedRays b = random_rays(kind, 9, 7);
    for (const RayKeyEntry& entry : kRayKeys) {
      const RayKey key = entry.key;
      std::uint32_t one_used = 0, three_used = 0;
      const auto one = make_keys(Executor(1), b.batch, key, 64, b.box, &one_used);
      EXPECT_EQ(one, make_keys(Executor(3), b.batch, key, 64, b.box, &three_used));
      EXPECT_EQ(one_used, three_used);
    }
  }
}

TEST(Keys, AcceptDegenerateRaysAndBoxes) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  RayBatch batch;
  batch.kind = RayKind::kReflection;
  batch.rays = {{{0, 0, 0}, 0, {0, 0, 0}, kInfinity},      {{0, 0, 0}, 0, {1, 0, 0}, kInfinity},
                {{0, 0, 0}, 0, {1e-45f, 0, 0}, kInfinity}, {{3e38f, 0, 0}, 0, {3e38f, 0, 0}, 9},
                {{9, 9, 9}, 0, {1, 1, 1}, kInfinity},      {{9, 9, 9}, 5, {-1, -1, -1}, kInfinity}};
  batch.pixels.assign(batch.rays.size(), 0);
  batch.keys.assign(batch.rays.size(), 0);
  const Executor executor(1);
  for (const Box& box : {Box{}, Box{{0, 0, 0}, {0, 0, 0}}, Box{{-1, 0, -1}, {1, 0, 1}},
                         Box{{-3e38f, -1, -1}, {3e38f, 1, 1}}}) {
    for (const RayKeyEntry& entry : kRayKeys) {
      const RayKey key = entry.key;
      for (const std::uint32_t bits : {32u, 64u}) {
        std::uint32_t used = 0;
        for (const std::uint64_t k : make_keys(executor, batch, key, bits, box, &used))
          EXPECT_EQ(used < 64 ? k >> used : 0, 0u) << to_string(key);
      }
    }
  }
  std::uint32_t used = 0;
  EXPECT_TRUE(make_keys(executor, {}, RayKey::kFiveHilbert, 64, {}, &used).empty());
}

TEST(Keys, RaysStartAndEndInTheBox) {
  const Box box{{-1, -2, -3}, {4, 2, 1}};
  Random random(8);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 inside{random.between(-1, 4), random.between(-2, 2), random.between(-3, 1)};
    const Vec3 d = random.direction();
    const float back = random.unit() * 30;
    const RayEnds ends = ray_ends(box, {inside - d * back, 0, d});
    for (const Vec3 p : {ends.start, ends.end}) {
      EXPECT_LE(max_component(max(box.min - p, p - box.max)), 1e-4f) << i;
    }
    EXPECT_GE(dot(ends.end - ends.start, d), -1e-4f);
    const RayEnds short_ends = ray_ends(box, {inside, 0, d * 1e-3f, 1});
    EXPECT_LE(length(short_ends.end - short_ends.start), 1.1e-3f);
  }
}

TEST(Keys, SortedRaysLieNearTheirNeighboursAlongHilbertCurvesMostOfAll) {
  Random random(9);
  KeyedRays b = random_rays(RayKind::kReflection, 40, 10);
  const auto path_length = [&](RayKey key) {
    std::uint32_t used = 0;
    const auto keys = make_keys(Executor(1), b.batch, key, 64, b.box, &used);
    std::vector<std::size_t> order(keys.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](auto p, auto q) { return keys[p] < keys[q]; });
    double sum = 0;
    for (std::size_t i = 1; i < order.size(); ++i) {
      const RayEnds p = ray_ends(b.box, b.batch.rays[order[i - 1]]);
      const RayEnds q = ray_ends(b.box, b.batch.rays[order[i]]);
      sum += double{length(p.start - q.start)} + double{length(p.end - q.end)};
    }
    return sum;
  };
  for (Ray& ray : b.batch.rays) ray.origin = random.in_box(1);
  EXPECT_LT(path_length(RayKey::kTwoPointHilbert), path_length(RayKey::kTwoPointMorton));
  EXPECT_LT(path_length(RayKey::kTwoPointMorton), 0.5 * path_length(RayKey::kRaster));
}

TEST(Keys, ThePublishedAzimuthDependsOnlyOnTheSignOfX) {
  Random random(11);
  std::set<std::uint32_t> coded, corrected;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 d = random.direction();
    const std::uint32_t key = published_shadow_key(0, d, true);
    coded.insert(key);
    corrected.insert(published_shadow_key(0, d, false));
    const std::uint32_t azimuth = d.x > 0 ? 11 : d.x < 0 ? 0 : 7;
    const auto polar = static_cast<std::uint32_t>(std::acos(d.z) * 5);
    EXPECT_EQ(key, (1u << 30) + (azimuth << 15) + polar + 1);
  }
  EXPECT_LE(coded.size(), 32u);
  EXPECT_GT(corrected.size(), 100u);
  EXPECT_EQ(published_shadow_key(3, {0, 0, 1}, true) >> 30, 0u);  // two bits wrap
}

TEST(Keys, ThePublishedBounceKeyHasItsFieldsInPlace) {
  const Vec3 o{0, 0, 2}, d{1, 0, 0};
  const std::uint32_t key = published_bounce_key(RayKind::kReflection, o, d, true);
  EXPECT_EQ(key, (31u << 19) + (0u << 12) + (11u << 5) + 7u + 1);
  const std::uint32_t refracted = published_bounce_key(RayKind::kRefraction, o, d, true);
  EXPECT_EQ(refracted, key + (2u << 26));
}

class RenderedKeys : public testing::TestWithParam<std::string> {};

TEST_P(RenderedKeys, GiveTheSameBitsAsBruteForce) {
  const SceneDescription scene = builtin_scene(GetParam());
  RenderOptions options = test::small_options(24);
  options.method = Method::kBrute;
  const RenderResult brute = render(scene, options);
  options.method = Method::kCrsh;
  for (const RayKeyEntry& entry : kRayKeys) {
    const RayKey key = entry.key;
    for (const std::uint32_t bits : {32u, 64u}) {
      options.key = key;
      options.key_bits = bits;
      options.mesh_culling = bits == 32;
      EXPECT_TRUE(test::same_bits(render(scene, options).beauty, brute.beauty))
          << to_string(key) << " " << bits;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Builtin, RenderedKeys, testing::Values("office", "cornell", "atrium"));

/// Tests of the shadow rays of primary hits, as a fraction of brute force.
double shadow_tests(const SceneDescription& scene, RayKey key, std::uint32_t bits) {
  RenderOptions options = test::small_options(192);
  options.bounces = 0;
  options.method = Method::kCrsh;
  options.key = key;
  options.key_bits = bits;
  for (const BatchStatistics& batch : render(scene, options).statistics.batches)
    if (batch.kind == RayKind::kShadow) return batch.relative();
  return 0;
}

TEST(RenderedKeys, CompactKeysSaveMostTestsOfTheOffice) {
  const SceneDescription scene = builtin_scene("office");
  const double raster = shadow_tests(scene, RayKey::kRaster, 32);
  const double pixels = shadow_tests(scene, RayKey::kPixelMorton, 32);
  ASSERT_GT(raster, 0);
  EXPECT_LT(pixels, raster / 2);
  for (const std::uint32_t bits : {32u, 64u}) {
    EXPECT_LT(shadow_tests(scene, RayKey::kOctahedralHilbert, bits), raster / 3) << bits;
    EXPECT_LT(shadow_tests(scene, RayKey::kEndPointHilbert, bits), raster / 5) << bits;
    EXPECT_LT(shadow_tests(scene, RayKey::kTwoPointHilbert, bits),
              shadow_tests(scene, RayKey::kTwoPointMorton, bits))
        << bits;
  }
}

TEST(RenderedKeys, RefuseOtherNumbersOfBits) {
  RenderOptions options = test::small_options();
  options.key_bits = 48;
  EXPECT_THROW((void)render(builtin_scene("cornell"), options), Error);
}

}  // namespace
}  // namespace raysheaf
