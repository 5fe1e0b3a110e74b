// Transforming vertices to world space gives the same bits on every SIMD target.
#include "api/api_support.h"
#include "api/scene/scene_transform.h"
#include "support/simd_targets.h"

namespace raysheaf::test {
namespace {

TEST(TransformPoints, EqualsTransformPoint) {
  Random random(3);
  Affine a;
  for (auto& row : a.m)
    for (float& x : row) x = random.between(-3, 3);
  std::vector<Vec3> from(37);
  for (Vec3& p : from) p = random.in_box(random.below(2) == 0 ? 1e-3f : 1e3f);
  for_each_simd_target([&](const char* target) {
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
  for_each_simd_target([&](const char* target) {
    for (std::size_t at = 0; at < 37; ++at) {
      for (const float wrong : {1.1e18f, -2e30f, kInfinity, kNaN}) {
        std::vector<Vec3> from(37, Vec3{1, 2, 3}), to(37);
        (at % 3 == 0 ? from[at].x : at % 3 == 1 ? from[at].y : from[at].z) = wrong;
        EXPECT_FALSE(transform_points(Affine{}, from.data(), 37, to.data()))
            << target << " " << at << " " << wrong;
      }
    }
  });
}

}  // namespace
}  // namespace raysheaf::test
