#include "hierarchy/hierarchy.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace raysheaf {
namespace {

using test::Random;

std::vector<Ray> wandering_rays(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Ray> rays;
  Vec3 origin = random.in_box(10), axis = random.direction();
  for (std::size_t i = 0; i < count; ++i) {
    if (random.below(50) == 0) origin = random.in_box(10), axis = random.direction();
    rays.push_back({origin + random.in_box(0.1f), 0, random.direction_near(axis, 0.1f), 1});
  }
  return rays;
}

bool contains(const RayBound& bound, const Ray& ray) {
  if (length(ray.origin - bound.origins.center) > radius_grown(bound.origins.radius)) return false;
  if (bound.directions.whole()) return true;
  const Vec3 d = normalized(ray.direction);
  return dot(d, bound.directions.axis) > 0 &&
         length(cross(d, bound.directions.axis)) <= bound.directions.sin_angle;
}

TEST(Hierarchy, EveryRayIsInsideAllItsAncestors) {
  const Executor executor(2);
  for (const std::size_t count : {1u, 7u, 8u, 9u, 64u, 65u, 1000u, 4097u}) {
    const std::vector<Ray> rays = wandering_rays(count, count);
    for (const std::uint32_t branching : {2u, 8u, 16u}) {
      const RayHierarchy tree = build_hierarchy(executor, rays, branching, 4);
      std::size_t width = 1, nodes = count;
      for (std::uint32_t l = 1; l <= 4; ++l) {
        width *= branching;
        nodes = (nodes + branching - 1) / branching;
        ASSERT_EQ(tree.level(l).size(), nodes);
        for (std::size_t i = 0; i < count; ++i)
          ASSERT_TRUE(contains(tree.level(l)[i / width], rays[i]));
      }
    }
  }
}

TEST(Hierarchy, DoesNotDependOnTheNumberOfThreads) {
  const std::vector<Ray> rays = wandering_rays(5000, 3);
  const RayHierarchy one = build_hierarchy(Executor(1), rays, 8, 3);
  const RayHierarchy many = build_hierarchy(Executor(5), rays, 8, 3);
  for (std::uint32_t l = 1; l <= 3; ++l) {
    for (std::size_t i = 0; i < one.level(l).size(); ++i) {
      EXPECT_EQ(one.level(l)[i].directions.sin_angle, many.level(l)[i].directions.sin_angle);
      EXPECT_EQ(one.level(l)[i].origins.radius, many.level(l)[i].origins.radius);
    }
  }
}

TEST(Hierarchy, NoRaysMakeEmptyLevels) {
  const RayHierarchy tree = build_hierarchy(Executor(2), View<const Ray>(), 8, 2);
  EXPECT_EQ(tree.top(), 2u);
  EXPECT_TRUE(tree.level(1).empty());
  EXPECT_TRUE(tree.level(2).empty());
}

}  // namespace
}  // namespace raysheaf
