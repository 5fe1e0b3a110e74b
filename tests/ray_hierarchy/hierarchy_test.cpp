#include "paper/ray_hierarchy/hierarchy.h"

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

const Box kScene{{-12, -11, -10}, {9, 10, 11}};

const std::vector<BundleBound>& each_bound() {
  static const std::vector<BundleBound> all{BundleBound::kSphereCone, BundleBound::kFiniteCone,
                                            BundleBound::kShaft, BundleBound::kFrustum,
                                            BundleBound::kShaftAndCone};
  return all;
}

bool contains(const RayBound& bound, const Ray& ray) {
  if (length(ray.origin - bound.origins.center) > radius_grown(bound.origins.radius)) return false;
  if (bound.directions.whole()) return true;
  const Vec3 d = normalized(ray.direction);
  return dot(d, bound.directions.axis) > 0 &&
         length(cross(d, bound.directions.axis)) <= bound.directions.sin_angle;
}

/// Exact, without tolerance: boxes are computed from boxes.
bool inside(const Box& box, const Box& other) {
  return min_component(box.min - other.min) >= 0 && min_component(other.max - box.max) >= 0;
}

float reach_of(const Ray& ray) {
  return length(farthest(end_of(ray, kScene), ray.origin));
}

bool contains(const FiniteCone& bound, const Ray& ray) {
  return contains(bound.rays, ray) && reach_of(ray) <= bound.reach;
}

bool contains(const Shaft& bound, const Ray& ray) {
  return inside({ray.origin, ray.origin}, bound.origins) && inside(end_of(ray, kScene), bound.ends);
}

bool contains(const Frustum& bound, const Ray& ray) {
  const Box origin{ray.origin, ray.origin}, end = end_of(ray, kScene);
  const Vec3 d = ray.direction / max_component(abs(ray.direction));
  return inside(origin, bound.origins) && inside({d, d}, bound.directions) &&
         inside(box_union(origin, end), bound.hull) &&
         max_component(farthest(end, ray.origin)) <= bound.reach;
}

bool contains(const ShaftCone& bound, const Ray& ray) {
  return contains(bound.shaft, ray) && contains(bound.cone, ray);
}

template <class Bound>
void expect_all_inside(const std::vector<Ray>& rays, std::uint32_t branching) {
  const auto tree = build_hierarchy<Bound>(Executor(2), rays, kScene, branching, 4);
  std::size_t width = 1, nodes = rays.size();
  for (std::uint32_t l = 1; l <= 4; ++l) {
    width *= branching;
    nodes = (nodes + branching - 1) / branching;
    ASSERT_EQ(tree.level(l).size(), nodes);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ASSERT_TRUE(contains(tree.level(l)[i / width], rays[i]));
  }
}

TEST(Hierarchy, EveryRayIsInsideAllItsAncestors) {
  for (const std::size_t count : {1u, 7u, 8u, 9u, 64u, 65u, 1000u, 4097u}) {
    std::vector<Ray> rays = wandering_rays(count, count);
    for (std::size_t i = 0; i < count; i += 3)
      rays[i].t_max = std::numeric_limits<float>::infinity();
    for (const std::uint32_t branching : {2u, 8u, 16u}) {
      for (const BundleBound bound : each_bound()) {
        SCOPED_TRACE(to_string(bound));
        with_bound(bound, [&]<class Bound>(std::type_identity<Bound> /*type*/) {
          expect_all_inside<Bound>(rays, branching);
        });
      }
    }
  }
}

TEST(Hierarchy, DoesNotDependOnTheNumberOfThreads) {
  const std::vector<Ray> rays = wandering_rays(5000, 3);
  const auto one = build_hierarchy<ShaftCone>(Executor(1), rays, kScene, 8, 3);
  const auto many = build_hierarchy<ShaftCone>(Executor(5), rays, kScene, 8, 3);
  for (std::uint32_t l = 1; l <= 3; ++l) {
    for (std::size_t i = 0; i < one.level(l).size(); ++i) {
      const ShaftCone &a = one.level(l)[i], &b = many.level(l)[i];
      EXPECT_EQ(a.cone.rays.directions.sin_angle, b.cone.rays.directions.sin_angle);
      EXPECT_EQ(a.cone.rays.origins.radius, b.cone.rays.origins.radius);
      EXPECT_EQ(a.cone.reach, b.cone.reach);
      EXPECT_TRUE(inside(a.shaft.ends, b.shaft.ends) && inside(b.shaft.ends, a.shaft.ends));
    }
  }
}

TEST(Hierarchy, NoRaysMakeEmptyLevels) {
  const auto tree = build_hierarchy<Shaft>(Executor(2), View<const Ray>(), kScene, 8, 2);
  EXPECT_EQ(tree.top(), 2u);
  EXPECT_TRUE(tree.level(1).empty());
  EXPECT_TRUE(tree.level(2).empty());
}

}  // namespace
}  // namespace raysheaf
