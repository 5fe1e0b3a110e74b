#include <gtest/gtest.h>

#include "intersect/brute_force.h"
#include "intersect/facing_body.h"
#include "scene/flat_arrays.h"
#include "support/simd_targets.h"
#include "support/soups.h"

namespace raysheaf {
namespace {

using test::SoupKind;

FlatArrays flat(const Executor& executor, const SceneDescription& scene) {
  return {executor, flatten(executor, scene, mesh_bounds(executor, scene))};
}

/// The contract, implemented as simply as possible.
RayHit reference_closest(const TriangleView& scene, const Ray& ray, Facing facing) {
  RayHit best;
  for (std::uint32_t i = 0; i < scene.count; ++i) {
    TriangleHit hit;
    if (intersect_triangle(make_ray_setup(ray), scene.corner(i, 0), scene.corner(i, 1),
                           scene.corner(i, 2), &hit) &&
        shows(facing, scene.flags[i], hit.front))
      best.take(hit.t, i);
  }
  return best;
}

TEST(IntersectList, EveryTargetGivesTheScalarAnswers) {
  const Executor executor(2);
  for (const SoupKind kind : test::soup_kinds()) {
    const SceneDescription scene = test::soup(kind, 333, 11);
    const FlatArrays triangles = flat(executor, scene);
    const std::vector<Ray> rays = test::rays_at(scene, 300, 5);
    for (const Facing facing : {Facing::kBoth, Facing::kSkipBackOfSingleSided}) {
      std::vector<RayHit> expected;
      for (const Ray& ray : rays)
        expected.push_back(reference_closest(triangles.view(), ray, facing));
      test::for_each_simd_target([&](const char* target) {
        std::vector<RayHit> hits(rays.size());
        ProgressMeter meter;
        intersect_brute_force(executor, triangles.view(), rays, facing, hits, &meter);
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
  const Executor executor(1);
  Mesh mesh;
  for (int i = 0; i < 40; ++i) test::add_triangle(&mesh, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
  SceneDescription scene;
  test::add_mesh(&scene, mesh);
  const FlatArrays triangles = flat(executor, scene);
  TriangleArrays reversed = triangle_run(triangles.view(), 0, 40);
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
