// Transforming vertices to world space gives the same bits on every SIMD target.
#include "scene/transform_points.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "support/simd_targets.h"
#include "tests/scene/support.h"

namespace raysheaf {
namespace {

using test::below;
using test::Random;

TEST(TransformPoints, EqualsTransformPoint) {
  Random random(3);
  const Affine a = test::random_map(random);
  std::vector<Vec3> from(37);
  for (Vec3& p : from) p = test::random_point(random, below(random, 2) == 0 ? 1e-3f : 1e3f);
  test::for_each_simd_target([&](const char* target) {
    for (std::size_t count = 0; count <= from.size(); ++count) {
      std::vector<Vec3> to(from.size(), {7, 7, 7});
      EXPECT_TRUE(transform_points(a, from.data(), count, to.data()));
      for (std::size_t i = 0; i < from.size(); ++i) {
        const Vec3 expected = i < count ? transform_point(a, from[i]) : Vec3{7, 7, 7};
        EXPECT_EQ(to[i], expected) << target << " " << i << " of " << count;
      }
    }
  });
}

TEST(TransformPoints, ReportsPointsOutsideTheWorld) {
  using Limits = std::numeric_limits<float>;
  test::for_each_simd_target([&](const char* target) {
    for (std::size_t at = 0; at < 37; ++at) {
      for (const float wrong : {1.1e18f, -2e30f, Limits::infinity(), Limits::quiet_NaN()}) {
        std::vector<Vec3> from(37, Vec3{1, 2, 3}), to(37);
        (at % 3 == 0 ? from[at].x : at % 3 == 1 ? from[at].y : from[at].z) = wrong;
        EXPECT_FALSE(transform_points(Affine{}, from.data(), 37, to.data()))
            << target << " " << at << " " << wrong;
      }
    }
  });
}

}  // namespace
}  // namespace raysheaf
