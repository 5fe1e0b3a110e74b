#include <gtest/gtest.h>

#include "intersect/facing_body.h"
#include "render/frame/brute_force.h"
#include "scene/flat_scene.h"
#include "support/simd_targets.h"
#include "support/soups.h"

namespace raysheaf {
namespace {

using test::SoupKind;

FlatScene flat(const Executor& executor, const SceneDescription& scene) {
  return flatten(executor, scene, mesh_bounds(executor, scene));
}

/// The contract, implemented as simply as possible.
RayHit reference_closest(const FlatScene& scene, const Ray& ray, Facing facing) {
  RayHit best;
  for (std::uint32_t i = 0; i < scene.triangle_count; ++i) {
    TriangleHit hit;
    const auto [a, b, c] = scene.corners(i);
    if (intersect_triangle(make_ray_setup(ray), a, b, c, &hit) &&
        shows(facing, scene.flags[i], hit.front))
      best.take(hit.t, i);
  }
  return best;
}

TEST(IntersectList, EveryTargetGivesTheScalarAnswers) {
  const Executor executor(2);
  for (const SoupKind kind : test::soup_kinds()) {
    const SceneDescription scene = test::soup(kind, 333, 11);
    const FlatScene triangles = flat(executor, scene);
    const std::vector<Ray> rays = test::rays_at(scene, 300, 5);
    for (const Facing facing : {Facing::kBoth, Facing::kSkipBackOfSingleSided}) {
      std::vector<RayHit> expected;
      for (const Ray& ray : rays) expected.push_back(reference_closest(triangles, ray, facing));
      test::for_each_simd_target([&](const char* target) {
        std::vector<RayHit> hits(rays.size());
        ProgressMeter meter;
        intersect_brute_force(executor, triangles.source(), rays, facing, hits, &meter);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          ASSERT_EQ(hits[i].triangle, expected[i].triangle)
              << target << " kind " << static_cast<int>(kind) << " ray " << i;
          ASSERT_EQ(hits[i].t, expected[i].t);
        }
      });
    }
  }
}

TEST(IntersectList, TiesGoToTheLeastTriangle) {
  const Vec3 corners[3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  std::vector<float> columns[3][3];
  TriangleArrays reversed;
  reversed.count = 40;
  for (int k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      columns[k][axis].assign(reversed.count, component(corners[k], axis));
      reversed.vertex[k][axis] = columns[k][axis].data();
    }
  std::vector<std::uint32_t> ids(40);
  for (std::uint32_t i = 0; i < 40; ++i) ids[i] = 39 - i;
  reversed.ids = ids.data();
  RayHit best;
  intersect_list(make_ray_setup({{0, 0, 1}, 0, {0, 0, -1}, 10}), reversed, Facing::kBoth, &best);
  EXPECT_EQ(best.triangle, 0u);
  EXPECT_EQ(best.t, 1);
}

TEST(IntersectList, EmptyListKeepsTheBestHit) {
  RayHit best{2, 7};
  intersect_list(make_ray_setup({{0, 0, 1}, 0, {0, 0, -1}, 10}), TriangleArrays{}, Facing::kBoth,
                 &best);
  EXPECT_EQ(best.triangle, 7u);
}

}  // namespace
}  // namespace raysheaf
