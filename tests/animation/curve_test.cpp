// Compares curves with values that were computed by hand.
#include "animation/curve.h"

#include <gtest/gtest.h>

#include <cmath>

namespace raysheaf {
namespace {

double value_at(const Curve& curve, double time) {
  double value[1];
  sample_curve(curve, time, value);
  return value[0];
}

TEST(Curve, HoldsTheEndsAndMeetsEveryKey) {
  for (const Interpolation kind : {Interpolation::kStep, Interpolation::kLinear}) {
    const Curve curve{kind, {1, 2, 4}, {10, 20, -5}};
    EXPECT_EQ(value_at(curve, 0), 10);
    EXPECT_EQ(value_at(curve, 1), 10);
    EXPECT_EQ(value_at(curve, 2), 20);
    EXPECT_EQ(value_at(curve, 4), -5);
    EXPECT_EQ(value_at(curve, 1e9), -5);
  }
  EXPECT_EQ(value_at({Interpolation::kLinear, {3}, {7}}, 3.5), 7);
}

TEST(Curve, StepsAndRuns) {
  const Curve step{Interpolation::kStep, {1, 2, 4}, {10, 20, -5}};
  EXPECT_EQ(value_at(step, 1.999), 10);
  EXPECT_EQ(value_at(step, 3.999), 20);
  const Curve linear{Interpolation::kLinear, {1, 2, 4}, {10, 20, -5}};
  EXPECT_NEAR(value_at(linear, 1.25), 12.5, 1e-12);
  EXPECT_NEAR(value_at(linear, 3), 7.5, 1e-12);
}

// Between the keys, which are 2 s apart: v0 = 1, b0 = 3, a1 = -1, v1 = 5. Half-way, Hermite's
// weights are 1/2, 2/8, 1/2, -2/8: (1 + 5) / 2 + (3 + 1) / 4 = 4.
TEST(Curve, SplinesFollowTheirTangents) {
  const Curve spline{Interpolation::kCubicSpline, {0, 2}, {9, 1, 3, -1, 5, 9}};
  EXPECT_EQ(value_at(spline, 0), 1);
  EXPECT_EQ(value_at(spline, 2), 5);
  EXPECT_NEAR(value_at(spline, 1), 4, 1e-12);
  const double h = 1e-5;
  EXPECT_NEAR((value_at(spline, h) - value_at(spline, 0)) / h, 3, 1e-3);
  EXPECT_NEAR((value_at(spline, 2) - value_at(spline, 2 - h)) / h, -1, 1e-3);
}

TEST(Curve, SamplesEveryNumber) {
  const Curve curve{Interpolation::kLinear, {0, 1}, {0, 1, 2, 10, 21, 32}};
  double value[3];
  sample_curve(curve, 0.5, value);
  EXPECT_EQ(value[0], 5);
  EXPECT_EQ(value[1], 11);
  EXPECT_EQ(value[2], 17);
}

TEST(Curve, TurnsEvenlyAlongTheShorterArc) {
  const float s = std::sqrt(0.5f);
  // From the identity to 90 degrees about z, and to the same rotation as a negated quaternion.
  for (const float sign : {1.0f, -1.0f}) {
    const Curve curve{Interpolation::kLinear, {0, 1}, {0, 0, 0, 1, 0, 0, sign * s, sign * s}};
    const auto third = sample_rotation(curve, 1.0 / 3);
    EXPECT_NEAR(third[2], std::sin(M_PI / 12), 1e-7);
    EXPECT_NEAR(third[3], std::cos(M_PI / 12), 1e-7);
  }
  const Curve same{Interpolation::kLinear, {0, 1}, {0, 0, 2, 0, 0, 0, 2, 0}};
  EXPECT_NEAR(sample_rotation(same, 0.4)[2], 1, 1e-12);
}

TEST(Curve, SplinesOfRotationsHaveUnitLength) {
  const float s = std::sqrt(0.5f);
  const Curve curve{Interpolation::kCubicSpline, {0, 1}, {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0,
                                                          0, 0, 0, 0, 0, 0, s, s, 0, 0, 0, 0}};
  for (const double time : {0.0, 0.3, 0.5, 0.9, 1.0}) {
    const auto q = sample_rotation(curve, time);
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-12);
  }
}

}  // namespace
}  // namespace raysheaf
