#include "intersect/exact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>

#include "intersect/triangle_body.h"
#include "lab/verify/pairs.h"
#include "lab/verify/placed_pairs.h"
#include "raysheaf/scene.h"
#include "tests/verify/big_integer.h"

namespace raysheaf::checks {
namespace {

using test::BigInteger;

BigInteger big_determinant(const Rows& rows) {
  BigInteger m[3][3];
  for (std::size_t i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      m[i][k] = BigInteger(component(rows[i].to, k)) - BigInteger(component(rows[i].from, k));
  const auto minor = [&](int i, int k) { return m[1][i] * m[2][k] - m[1][k] * m[2][i]; };
  return m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1);
}

/// The differences of three points from a fourth.
Rows some_rows(Random* random) {
  const PairFamily& family =
      pair_families()[random->below(static_cast<std::uint32_t>(pair_families().size()))];
  const RayAndTriangle pair = family.make(random);
  const auto& [a, b, c] = pair.corners;
  const Vec3 o = pair.ray.origin, d = pair.ray.direction;
  switch (random->below(4)) {
    case 0:
      return {Row{d, {}}, Row{b, a}, Row{c, a}};
    case 1:
      return {Row{d, {}}, Row{a, o}, Row{b, o}};
    case 2:
      return {Row{a, o}, Row{b, o}, Row{c, o}};
    default:
      return {Row{b, a}, Row{c, a}, Row{b, c}};  // singular
  }
}

TEST(Exact, BigIntegersCalculate) {
  const BigInteger two(0x1p-148f), three = two + BigInteger(0x1p-149f);
  EXPECT_EQ((two * three - three - three).sign(), 0);
  EXPECT_EQ((two - three).sign(), -1);
  EXPECT_EQ(((two - three) * (two - three)).sign(), 1);
  EXPECT_EQ((-three).value(0), -3);
  for (const float x : {0.0f, -0.0f, 1.0f, -1.5f, 0x1p-149f, -0x1.8p-140f, 0x1.fffffep127f, 1e-30f})
    EXPECT_EQ(BigInteger(x).value(-149), double{x}) << x;
  const BigInteger most(0x1.fffffep127f), twice = most + most;
  EXPECT_DOUBLE_EQ((twice * twice * twice).value(-447), std::pow(0x1.fffffep128, 3));
}

TEST(Exact, DeterminantsAreThoseOfBigIntegers) {
  Random random(1);
  int zeros = 0;
  for (int trial = 0; trial < 200000; ++trial) {
    const Rows rows = some_rows(&random);
    const BigInteger big = big_determinant(rows);
    const double expected = big.value(-447), found = determinant(rows);
    ASSERT_EQ(sign_of_determinant(rows), big.sign()) << trial;
    ASSERT_EQ(found > 0 ? 1 : found < 0 ? -1 : 0, big.sign()) << trial;
    ASSERT_LE(std::fabs(found - expected), std::fabs(expected) * 0x1p-40) << trial;
    zeros += big.sign() == 0 ? 1 : 0;
  }
  EXPECT_GT(zeros, 50000);
  EXPECT_LT(zeros, 150000);
}

/// How many hits binary64 values without integers.
TEST(Exact, BoundsOfDeterminantsHold) {
  for (const PairFamily& family : pair_families()) {
    Random random(3);
    int hits = 0, valued = 0;
    for (int trial = 0; trial < 20000; ++trial) {
      const RayAndTriangle pair = family.make(&random);
      const auto& [a, b, c] = pair.corners;
      const Vec3 o = pair.ray.origin, direction = pair.ray.direction;
      const Row d{direction, {}}, e{b, a}, f{c, a}, k{a, o};
      const Determinants x = determinants(o, direction, a, b, c);
      const auto expect = [&](double value, double error, const Rows& rows) {
        const double exact = big_determinant(rows).value(-447);
        EXPECT_LE(std::fabs(value - exact), error + 0x1p-52 * std::fabs(exact))
            << family.name << ", " << trial;
      };
      expect(x.det, x.det_error, {e, f, d});
      expect(x.t, x.t_error, {e, f, k});
      expect(x.u, x.u_error, {k, d, f});
      expect(x.v, x.v_error, {d, k, e});
      if (HasFailure()) return;
      const bool met = exact_answer(pair.ray, a, b, c).meets;
      hits += met ? 1 : 0;
      valued += met && x.give_values() ? 1 : 0;
    }
    if (family.name == std::string_view("from far")) {
      EXPECT_GT(valued, hits * 0.99);
    }
    RecordProperty(family.name, std::to_string(valued) + " of " + std::to_string(hits));
  }
}

/// Hit or miss from barycentric coordinates of big integers. It uses another formula than the
/// oracle: the point where the line meets the plane.
struct BigAnswer {
  bool meets = false;
  double t = 0, u = 0, v = 0;

  explicit BigAnswer(const RayAndTriangle& pair) {
    const auto& [a, b, c] = pair.corners;
    const Row d{pair.ray.direction, {}}, ab{b, a}, ac{c, a}, from{pair.ray.origin, a};
    const auto reversed = [](const Row& row) { return Row{row.from, row.to}; };
    // origin + t d = a + u ab + v ac, by Cramer's rule.
    BigInteger det = big_determinant({ab, ac, reversed(d)});
    if (det.sign() == 0) return;
    BigInteger of_u = big_determinant({from, ac, reversed(d)});
    BigInteger of_v = big_determinant({ab, from, reversed(d)});
    BigInteger of_t = big_determinant({ab, ac, from});
    if (det.sign() < 0) det = -det, of_u = -of_u, of_v = -of_v, of_t = -of_t;
    meets = of_u.sign() >= 0 && of_v.sign() >= 0 && (det - of_u - of_v).sign() >= 0;
    const double scale = det.value(-447);
    t = of_t.value(-447) / scale;
    u = of_u.value(-447) / scale;
    v = of_v.value(-447) / scale;
  }
};

enum class Outcome { kHit, kMiss, kWrong };

/// Whether `exact_answer` gives the same.
Outcome outcome_of(const RayAndTriangle& pair) {
  const auto& [a, b, c] = pair.corners;
  const BigAnswer expected(pair);
  const ExactAnswer found = exact_answer(pair.ray, a, b, c);
  const auto near = [](double x, double y) { return std::fabs(x - y) <= std::fabs(y) * 0x1p-38; };
  const bool hits = expected.meets && expected.t >= 0;
  if (found.meets != expected.meets || meets_exactly(pair.ray, a, b, c) != hits ||
      !near(found.t, expected.t) || !near(found.u, expected.u) || !near(found.v, expected.v))
    return Outcome::kWrong;
  return hits ? Outcome::kHit : Outcome::kMiss;
}

TEST(Exact, AnswersAreThoseOfBigIntegers) {
  for (const PairFamily& family : pair_families()) {
    Random random(2);
    int hits = 0, misses = 0;
    for (int trial = 0; trial < 20000; ++trial) {
      const Outcome outcome = outcome_of(family.make(&random));
      ASSERT_NE(outcome, Outcome::kWrong) << family.name << ", " << trial;
      (outcome == Outcome::kHit ? hits : misses) += 1;
    }
    EXPECT_GT(hits, 500) << family.name;
    EXPECT_GT(misses, &family == &pair_families().front() ? -1 : 500) << family.name;
  }
}

/// Those of instances that move, where the library's transforms of the time place them.
TEST(Exact, AnswersInInstancesAreThoseOfBigIntegers) {
  Random random(4);
  int hits = 0, misses = 0;
  for (int trial = 0; trial < 100'000; ++trial) {
    const PlacedPair pair = make_placed_pair(trial % 4 != 0, &random);
    const Affine map = transform_at(pair.transforms, pair.time);
    const bool is_identity = map.m == Affine().m;
    for (std::size_t i = 0; i < 3; ++i)
      ASSERT_TRUE(pair.seen.corners[i] ==
                  (is_identity ? pair.mesh[i] : transform_point(map, pair.mesh[i])))
          << pair.family << ", " << trial;
    const Outcome outcome = outcome_of(pair.seen);
    ASSERT_NE(outcome, Outcome::kWrong) << pair.family << ", " << trial;
    (outcome == Outcome::kHit ? hits : misses) += 1;
  }
  EXPECT_GT(hits, 20'000);
  EXPECT_GT(misses, 20'000);
}

/// Rows between two points: their differences are not representable as floats.
TEST(Exact, DifferencesAreNotRounded) {
  const Vec3 far{0x1p60f, 0, 0};
  const Row x{{1, 0, 0}, {}}, y{{0, 1, 0}, {}}, z{{0, 0, 1}, {}};
  const Row nearly_x{far, {0x1p60f, -0x1p-60f, 0}};  // (0, 2^-60, 0)
  EXPECT_EQ(determinant({x, y, z}), 1);
  EXPECT_EQ(determinant({nearly_x, x, z}), -0x1p-60);
  EXPECT_EQ(determinant({x, x, z}), 0);
  const Row sum{{0x1p60f, 0x1p-80f, 0}, {}}, along{{0x1p60f, 0, 0}, {}};
  EXPECT_EQ(determinant({along, sum, z}), 0x1p-20);
  // (2^60 - 2^-60, 1, 0): not representable in binary64.
  const Row less{{0x1p60f, 1, 0}, {0x1p-60f, 0, 0}};
  EXPECT_EQ(determinant({less, Row{{0x1p60f, 1, 0}, {}}, z}), -0x1p-60);
}

TEST(Exact, AnswersForARayAndATriangle) {
  const Vec3 a{0, 0, 2}, b{4, 0, 2}, c{0, 4, 2};
  const ExactAnswer hit = exact_answer({{1, 2, 0}, 0, {0, 0, 4}}, a, b, c);
  EXPECT_TRUE(hit.meets);
  EXPECT_EQ(hit.t, 0.5);
  EXPECT_EQ(hit.u, 0.25);
  EXPECT_EQ(hit.v, 0.5);
  // Edges and corners belong to the triangle; points beyond them by the smallest float do not.
  const auto meets = [&](float x, float y) {
    return exact_answer({{x, y, 0}, 0, {0, 0, 1}}, a, b, c).meets;
  };
  EXPECT_TRUE(meets(0, 0));
  EXPECT_TRUE(meets(2, 2));
  EXPECT_TRUE(meets(0, 3));
  EXPECT_FALSE(meets(-1e-40f, 3));
  EXPECT_FALSE(meets(std::nextafter(2.0f, 3.0f), 2));
  EXPECT_FALSE(exact_answer({{1, 1, 2}, 0, {1, 0, 0}}, a, b, c).meets);  // in its plane
  EXPECT_FALSE(exact_answer({{1, 1, 2}, 0, {0, 0, 1}}, a, b, b).meets);  // no area
  EXPECT_FALSE(hit.front);
  EXPECT_TRUE(exact_answer({{1, 2, 0}, 0, {0, 0, 4}}, a, c, b).front);
  // Behind the origin by less than any float.
  const Vec3 small = Vec3{1, 1, 1} * 0x1p-40f;
  const Ray behind{{0, 0, std::nextafter(0x1p-39f, 1.0f)}, 0, {0, 0, 0x1p120f}};
  EXPECT_LT(exact_answer(behind, a * small, b * small, c * small).t, 0);
  EXPECT_EQ(static_cast<float>(exact_answer(behind, a * small, b * small, c * small).t), 0);
  EXPECT_FALSE(meets_exactly(behind, a * small, b * small, c * small));
  EXPECT_TRUE(meets_exactly({{1, 1, 2}, 0, {0, 0, 1}}, a, b, c));
}

}  // namespace
}  // namespace raysheaf::checks
