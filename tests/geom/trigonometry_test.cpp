#include "base/trigonometry.h"

#include <gtest/gtest.h>

#include <numbers>

namespace raysheaf::test {
namespace {

constexpr double kStep = 0x1p-53;  // half a unit in the last place, relative

TEST(Trigonometry, SinesAndCosinesAreThoseOfTheLibrary) {
  for (int i = -200'000; i <= 200'000; ++i) {
    const double angle = i * 1.234567e-4;
    const auto [sine, cosine] = portable::sine_cosine(angle);
    ASSERT_NEAR(sine, std::sin(angle), 3 * kStep) << angle;
    ASSERT_NEAR(cosine, std::cos(angle), 3 * kStep) << angle;
    ASSERT_NEAR(portable::tangent(angle) * cosine, sine, 4 * kStep) << angle;
  }
  for (const double angle :
       {0.0, 1e-300, 1e-9, std::numbers::pi / 4, std::numbers::pi, 999'999.5}) {
    EXPECT_NEAR(portable::sine_cosine(angle).sine, std::sin(angle), 4 * kStep) << angle;
    EXPECT_NEAR(portable::sine_cosine(-angle).cosine, std::cos(angle), 4 * kStep) << angle;
  }
  EXPECT_EQ(portable::sine_cosine(0).sine, 0);
  EXPECT_EQ(portable::sine_cosine(0).cosine, 1);
}

TEST(Trigonometry, AnglesAreThoseOfTheLibrary) {
  for (int i = 0; i <= 100'000; ++i) {
    const double angle = (i - 50'000) * (std::numbers::pi / 50'000);
    const double y = 3 * std::sin(angle), x = 3 * std::cos(angle);
    ASSERT_NEAR(portable::angle_of(y, x), std::atan2(y, x), 8 * kStep) << angle;
    const double cosine = (i - 50'000) / 50'000.0;
    ASSERT_NEAR(portable::arc_cosine(cosine), std::acos(cosine), 8 * kStep) << cosine;
  }
  EXPECT_EQ(portable::angle_of(0, 0), 0);
  EXPECT_EQ(portable::angle_of(0, -2), portable::kPi);
  EXPECT_EQ(portable::angle_of(2, 0), portable::kPi / 2);
  EXPECT_EQ(portable::arc_cosine(1), 0);
  EXPECT_EQ(portable::arc_cosine(-1), portable::kPi);
  // Small angles keep their relative precision.
  EXPECT_DOUBLE_EQ(portable::angle_of(1e-12, 1), 1e-12);
  EXPECT_DOUBLE_EQ(portable::angle_of(-3e-200, 2e-190), std::atan2(-3e-200, 2e-190));
}

}  // namespace
}  // namespace raysheaf::test
