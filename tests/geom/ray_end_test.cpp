#include "geom/ray_end.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace raysheaf {
namespace {

using test::Random;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The distance at which the ray leaves the box, in binary64; negative if it misses the box.
double exit_of(const Ray& ray, const Box& box) {
  double enter = 0, exit = double{ray.t_max};
  for (int i = 0; i < 3; ++i) {
    const double o = double{component(ray.origin, i)}, d = double{component(ray.direction, i)};
    const double a = (double{component(box.min, i)} - o) / d;
    const double b = (double{component(box.max, i)} - o) / d;
    enter = std::max(enter, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  return enter <= exit ? exit : -1;
}

TEST(RayEnd, HoldsWhereTheRayLeavesTheSceneOrEnds) {
  Random random(5);
  int inside = 0;
  for (const float scale : {1.0f, 1e-9f, 1e9f, 1e17f}) {
    for (int i = 0; i < 20000; ++i) {
      const Vec3 center = random.in_box(random.below(2) == 0 ? 0 : 100) * scale;
      const Box box{center - Vec3{1, 2, 3} * scale, center + Vec3{3, 2, 1} * scale};
      const Ray ray{center + random.in_box(5) * scale, 0,
                    random.direction() * (scale * random.between(0.01f, 10)),
                    random.below(2) == 0 ? kInfinity : random.between(0, 3)};
      const double exit = exit_of(ray, box);
      if (exit < 0) continue;
      ++inside;
      const Box end = end_of(ray, box);
      for (int k = 0; k < 3; ++k) {
        const double e =
            double{component(ray.origin, k)} + exit * double{component(ray.direction, k)};
        const double o = double{component(ray.origin, k)};
        // The end is exact, or rounded away from the origin.
        const double lo = double{component(end.min, k)}, hi = double{component(end.max, k)};
        ASSERT_LE(std::min(o, lo), e);
        ASSERT_GE(std::max(o, hi), e);
        ASSERT_LE(std::max(hi - e, e - lo), 2e-3 * double{scale}) << i;
      }
    }
  }
  EXPECT_GT(inside, 10000);
}

TEST(RayEnd, RaysThatMissTheSceneEndWhereTheyBegin) {
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  for (const Vec3 direction : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 1, 0.001f}}) {
    const Box end = end_of({{0, 0, 5}, 0, direction, kInfinity}, box);
    EXPECT_TRUE(end.min == (Vec3{0, 0, 5}) && end.max == (Vec3{0, 0, 5}));
  }
}

TEST(RayEnd, DirectionsOfAnyLengthHaveEnds) {
  const Box box{{-1, -1, -1}, {1, 1, 1}};
  for (const float length : {1e-45f, 1e-38f, 1e-20f, 1e20f, 1e38f}) {
    const Box end = end_of({{0, 0, -5}, 0, {0, 0, length}, kInfinity}, box);
    EXPECT_LE(end.min.z, 1 + 1e-3f) << length;
    EXPECT_GE(end.max.z, 1) << length;
    EXPECT_LE(end.max.z, 1 + 1e-3f) << length;
    EXPECT_LE(end.max.x, 1 + 1e-3f) << length;
  }
}

TEST(RayEnd, NoDirectionIsAtLeastNoNan) {
  const Box end = end_of({{0, 0, 0}, 0, {0, 0, 0}, kInfinity}, {{-1, -1, -1}, {1, 1, 1}});
  EXPECT_TRUE(is_finite(end.min) && is_finite(end.max));
}

}  // namespace
}  // namespace raysheaf
