// The ray-triangle test decides as exact arithmetic on the given floats does. The oracle has a
// separate test (tests/verify/exact_test.cpp).
#include <gtest/gtest.h>

#include <cmath>

#include "intersect/exact.h"
#include "intersect/float_answer_body.h"
#include "intersect/plane.h"
#include "intersect/triangle_body.h"
#include "lab/verify/fault.h"
#include "lab/verify/pairs.h"

namespace raysheaf {
namespace {

using checks::PairFamily;
using checks::RayAndTriangle;
using checks::text_of;

constexpr int kPairsOfAFamily = 100'000;

/// A hit of the front becomes a hit of the back when two corners are swapped. Rotating the corners
/// keeps the side.
std::array<Vec3, 3> reordered(const std::array<Vec3, 3>& t, std::uint32_t turn, bool mirrored) {
  std::array<Vec3, 3> result{t[turn], t[(turn + 1) % 3], t[(turn + 2) % 3]};
  if (mirrored) std::swap(result[1], result[2]);
  return result;
}

class ExactPairs : public testing::TestWithParam<std::size_t> {
 protected:
  [[nodiscard]] static const PairFamily& family() { return checks::pair_families()[GetParam()]; }
};

TEST_P(ExactPairs, HitOrMissAndWhere) {
  checks::Random random(11);
  int hits = 0, wrong = 0;
  for (int i = 0; i < kPairsOfAFamily && wrong < 3; ++i) {
    RayAndTriangle pair = family().make(&random);
    pair.corners = reordered(pair.corners, random.below(3), random.one_in(2));
    const auto& [a, b, c] = pair.corners;
    TriangleHit hit{};
    const bool met = intersect_triangle(make_ray_setup(pair.ray), a, b, c, &hit);
    const std::string fault =
        checks::fault_of(pair.ray, pair.corners, exact_answer(pair.ray, a, b, c), met, hit);
    if (!fault.empty()) ADD_FAILURE() << "pair " << i << " of " << family().name << ": " << fault;
    wrong += fault.empty() ? 0 : 1;
    hits += met ? 1 : 0;
  }
  EXPECT_GT(hits, wrong == 0 ? kPairsOfAFamily / 50 : 0);
}

/// Where the binary32 filter is certain, exact arithmetic agrees.
TEST_P(ExactPairs, TheFloatFilterAgreesWithExactArithmetic) {
  checks::Random random(13);
  for (int i = 0; i < kPairsOfAFamily; ++i) {
    RayAndTriangle pair = family().make(&random);
    if (random.one_in(3)) pair.ray.t_max = random.between(0, 3);
    const auto& [a, b, c] = pair.corners;
    const RaySetup setup = make_ray_setup(pair.ray);
    const FloatAnswer floats = answer_in_floats(setup, a, b, c);
    if (floats.kind == FloatAnswer::kUnsure) continue;
    TriangleHit hit{};
    const bool met = intersect_triangle(setup, a, b, c, &hit);
    ASSERT_EQ(met, floats.kind == FloatAnswer::kHit) << "pair " << i << " of " << family().name;
    if (!met) continue;
    ASSERT_EQ(hit.front, floats.front) << "pair " << i << " of " << family().name;
    ASSERT_LE(floats.low, hit.t) << "pair " << i << " of " << family().name;
    ASSERT_GE(floats.high, hit.t) << "pair " << i << " of " << family().name;
  }
}

/// If the plane filter rejects a ray or its interval, exact arithmetic agrees.
TEST_P(ExactPairs, ThePlaneFilterRejectsOnlyMisses) {
  checks::Random random(14);
  int beyond = 0;
  for (int i = 0; i < kPairsOfAFamily; ++i) {
    RayAndTriangle pair = family().make(&random);
    const auto& [a, b, c] = pair.corners;
    TriangleHit line{};
    if (line_meets_triangle(pair.ray.origin, pair.ray.direction, a, b, c, &line) && line.t >= 0) {
      const float t = line.t, ulps = 1 + random.between(-4, 4) * 0x1p-23f;
      if (random.one_in(2)) pair.ray.t_max = t * ulps;
      if (random.one_in(4)) pair.ray.t_min = std::min(t * ulps, pair.ray.t_max);
      if (random.one_in(4)) {
        pair.ray.direction = pair.ray.direction * -1;
        pair.ray = {pair.ray.origin, -pair.ray.t_max, pair.ray.direction, -pair.ray.t_min};
      }
    }
    const RaySetup setup = make_ray_setup(pair.ray);
    const auto along = [&](Vec3 v) {
      return Vec3{component(v, setup.axis_x), component(v, setup.axis_y),
                  component(v, setup.axis_z)};
    };
    const SlopedRay sloped{along(setup.origin), setup.shear_x, setup.shear_y,
                           setup.shear_z,       setup.t_min,   setup.t_max};
    if (!Plane(along(a), along(b), along(c)).surely_beyond(sloped, along(a))) continue;
    ++beyond;
    TriangleHit hit{};
    ASSERT_FALSE(intersect_triangle(setup, a, b, c, &hit))
        << "pair " << i << " of " << family().name;
  }
  RecordProperty("beyond", beyond);
}

/// The reported t decides whether a hit is in [t_min, t_max], ends included.
TEST_P(ExactPairs, TheReportedTDecidesTheInterval) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  checks::Random random(12);
  for (int i = 0; i < kPairsOfAFamily / 10; ++i) {
    const RayAndTriangle pair = family().make(&random);
    const auto& [a, b, c] = pair.corners;
    const auto meets = [&](float t_min, float t_max, float* t) {
      Ray ray = pair.ray;
      ray.t_min = t_min, ray.t_max = t_max;
      TriangleHit hit{};
      const bool met = intersect_triangle(make_ray_setup(ray), a, b, c, &hit);
      *t = hit.t;
      return met;
    };
    float t, again;
    if (!meets(0, kFar, &t) || !std::isfinite(t)) continue;
    const std::string words = text_of(pair.ray, pair.corners) + ", t " + std::to_string(t);
    ASSERT_TRUE(meets(t, t, &again)) << words;
    ASSERT_EQ(again, t) << words;
    ASSERT_FALSE(meets(std::nextafter(t, kFar), kFar, &again)) << words;
    ASSERT_TRUE(t == 0 || !meets(0, std::nextafter(t, 0.0f), &again)) << words;
  }
}

INSTANTIATE_TEST_SUITE_P(Family, ExactPairs,
                         testing::Range(std::size_t{0}, checks::pair_families().size()),
                         [](const auto& family) {
                           std::string name = checks::pair_families()[family.param].name;
                           std::erase_if(name, [](char c) { return std::isalnum(c) == 0; });
                           return name;
                         });

/// Two triangles share an edge: a ray exactly on it hits both; a ray next to it hits one.
TEST(ExactPairs, AnEdgeBelongsToBothItsTriangles) {
  checks::Random random(13);
  const auto whole = [&] { return static_cast<float>(random.below(2001)) - 1000; };
  for (int i = 0; i < 100'000; ++i) {
    const Vec3 p{whole() * 4, whole() * 4, whole() * 4}, q{whole() * 4, whole() * 4, whole() * 4};
    const Vec3 r{whole(), whole(), whole()}, s{whole(), whole(), whole()};
    const auto quarter = static_cast<float>(random.below(5)) * 0.25f;
    const Vec3 on_edge = p + (q - p) * quarter, d{whole(), whole(), whole()};
    const Ray ray{on_edge - d * static_cast<float>(random.below(4)), 0, d,
                  std::numeric_limits<float>::infinity()};
    if (!(max_component(abs(d)) > 0)) continue;
    for (const Vec3 apex : {r, s}) {
      if (checks::sign_of_determinant({checks::Row{d, {}}, {q, p}, {apex, p}}) == 0) continue;
      TriangleHit hit{};
      ASSERT_TRUE(intersect_triangle(make_ray_setup(ray), p, q, apex, &hit))
          << text_of(ray, {p, q, apex});
      ASSERT_TRUE(intersect_triangle(make_ray_setup(ray), q, p, apex, &hit))
          << text_of(ray, {q, p, apex});
    }
  }
}

/// An edge that is split at a point with integer coordinates, as at a T-junction.
TEST(ExactPairs, ATJunctionOfWholeNumbersIsClosed) {
  checks::Random random(14);
  const auto whole = [&] { return static_cast<float>(random.below(401)) - 200; };
  for (int i = 0; i < 100'000; ++i) {
    const Vec3 p{whole() * 4, whole() * 4, 0}, q{whole() * 4, whole() * 4, 0};
    const Vec3 left{p.x - (q.y - p.y), p.y + (q.x - p.x), whole()};
    const Vec3 right{p.x + (q.y - p.y), p.y - (q.x - p.x), whole()};
    const Vec3 cut = p + (q - p) * 0.25f * static_cast<float>(1 + random.below(3));
    if (p == q) continue;
    Vec3 aim = p + (q - p) * 0.125f * static_cast<float>(1 + random.below(7));
    if (random.one_in(2)) aim.x = std::nextafter(aim.x, random.one_in(2) ? 1e9f : -1e9f);
    const Ray ray{aim + Vec3{0, 0, 1000}, 0, {0, 0, -7}, 1e9f};
    const RaySetup setup = make_ray_setup(ray);
    TriangleHit hit{};
    ASSERT_TRUE(intersect_triangle(setup, p, q, left, &hit) ||
                intersect_triangle(setup, cut, p, right, &hit) ||
                intersect_triangle(setup, q, cut, right, &hit))
        << text_of(ray, {p, q, left}) << ", cut at " << cut.x << " " << cut.y;
  }
}

}  // namespace
}  // namespace raysheaf
