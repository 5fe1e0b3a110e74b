#include "verify/exact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "verify/random.h"

namespace raysheaf::checks {
namespace {

__extension__ using Wide = __int128;

Wide integer_determinant(const std::int64_t (&m)[3][3]) {
  const auto minor = [&](int i, int k) {
    return Wide{m[1][i]} * m[2][k] - Wide{m[1][k]} * m[2][i];
  };
  return m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1);
}

/// Whole numbers, where 128 bits hold everything, at any power of two.
TEST(Exact, DeterminantsOfWholeNumbersAreRight) {
  Random random(1);
  int zeros = 0;
  for (int trial = 0; trial < 200000; ++trial) {
    std::int64_t m[3][3];
    const std::uint32_t most = random.one_in(2) ? 3 : 1u << 23;
    for (auto& row : m)
      for (std::int64_t& x : row) x = std::int64_t{random.below(2 * most)} - most;
    if (random.one_in(3))  // nearly singular: the last row is the sum of the others, or one off
      for (int k = 0; k < 3; ++k) m[2][k] = m[0][k] + m[1][k] + (random.one_in(6) ? 1 : 0);
    const int power = static_cast<int>(random.below(200)) - 110;
    const auto vector = [&](int i) {
      const auto at = [&](int k) { return std::ldexp(static_cast<float>(m[i][k]), power); };
      return Vec3{at(0), at(1), at(2)};
    };
    const double expected = std::ldexp(static_cast<double>(integer_determinant(m)), 3 * power);
    const double found = determinant({Row{vector(0), {}}, Row{vector(1), {}}, Row{vector(2), {}}});
    ASSERT_LE(std::fabs(found - expected), std::fabs(expected) * 0x1p-40) << trial;
    zeros += expected == 0 ? 1 : 0;
  }
  EXPECT_GT(zeros, 1000);
}

/// Rows from one point to another: differences that no float holds.
TEST(Exact, DifferencesAreNotRounded) {
  const Vec3 far{0x1p60f, 0, 0};
  const Row x{{1, 0, 0}, {}}, y{{0, 1, 0}, {}}, z{{0, 0, 1}, {}};
  const Row nearly_x{far, {0x1p60f, -0x1p-60f, 0}};  // (0, 2^-60, 0)
  EXPECT_EQ(determinant({x, y, z}), 1);
  EXPECT_EQ(determinant({nearly_x, x, z}), -0x1p-60);
  EXPECT_EQ(determinant({x, x, z}), 0);
  const Row sum{{0x1p60f, 0x1p-80f, 0}, {}}, along{{0x1p60f, 0, 0}, {}};
  EXPECT_EQ(determinant({along, sum, z}), 0x1p-20);
  const Row less{{0x1p60f, 1, 0}, {0x1p-60f, 0, 0}};  // (2^60 - 2^-60, 1, 0): no binary64 number
  EXPECT_EQ(determinant({less, Row{{0x1p60f, 1, 0}, {}}, z}), -0x1p-60);
}

TEST(Exact, AnswersForARayAndATriangle) {
  const Vec3 a{0, 0, 2}, b{4, 0, 2}, c{0, 4, 2};
  const ExactAnswer hit = exact_answer({{1, 2, 0}, 0, {0, 0, 4}}, a, b, c);
  EXPECT_TRUE(hit.meets);
  EXPECT_EQ(hit.t, 0.5);
  EXPECT_EQ(hit.u, 0.25);
  EXPECT_EQ(hit.v, 0.5);
  // Edges and corners belong to the triangle; the smallest float beyond them does not.
  const auto meets = [&](float x, float y) {
    return exact_answer({{x, y, 0}, 0, {0, 0, 1}}, a, b, c).meets;
  };
  EXPECT_TRUE(meets(0, 0));
  EXPECT_TRUE(meets(2, 2));
  EXPECT_TRUE(meets(0, 3));
  EXPECT_FALSE(meets(-1e-40f, 3));
  EXPECT_FALSE(meets(std::nextafter(2.0f, 3.0f), 2));
  EXPECT_FALSE(exact_answer({{1, 1, 2}, 0, {1, 0, 0}}, a, b, c).meets);  // in its plane
}

}  // namespace
}  // namespace raysheaf::checks
