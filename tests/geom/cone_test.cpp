#include "paper/bounds/cone.h"

#include <gtest/gtest.h>

#include "paper/bounds/ray_bound.h"
#include "support/random.h"

namespace raysheaf {
namespace {

using test::Random;

double angle_between(Vec3 a, Vec3 b) {
  const double cx = double{a.y} * b.z - double{a.z} * b.y,
               cy = double{a.z} * b.x - double{a.x} * b.z,
               cz = double{a.x} * b.y - double{a.y} * b.x;
  const double d = double{a.x} * b.x + double{a.y} * b.y + double{a.z} * b.z;
  return std::atan2(std::sqrt(cx * cx + cy * cy + cz * cz), d);
}

double half_angle(const Cone& cone) {
  return cone.whole() ? 3.14159265358979 : std::asin(double{cone.sin_angle});
}

bool contains(const RayBound& bound, const Ray& ray) {
  const Vec3 o = ray.origin - bound.origins.center;
  const double distance = std::sqrt(double{o.x} * o.x + double{o.y} * o.y + double{o.z} * o.z);
  return distance <= double{bound.origins.radius} &&
         angle_between(ray.direction, bound.directions.axis) <= half_angle(bound.directions);
}

std::vector<Ray> bundle(Random& random, std::size_t count, float spread, float extent) {
  const Vec3 axis = random.direction(), center = random.in_box(100);
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < count; ++i)
    rays.push_back({center + random.in_box(extent), 0,
                    random.direction_near(axis, spread) * random.between(1e-3f, 1e3f), 1});
  return rays;
}

TEST(RayBound, HoldsItsRaysAndIsNotAbsurdlyLoose) {
  Random random(1);
  for (const float spread : {0.0f, 1e-6f, 1e-3f, 0.05f, 0.5f, 0.9f, 5.0f}) {
    for (const float extent : {0.0f, 1e-3f, 1.0f, 50.0f}) {
      for (int i = 0; i < 300; ++i) {
        const std::vector<Ray> rays = bundle(random, 1 + random.below(9), spread, extent);
        const RayBound bound = bound_rays(rays);
        double widest = 0, farthest = 0;
        for (const Ray& ray : rays) {
          ASSERT_TRUE(contains(bound, ray)) << "spread " << spread << " extent " << extent;
          for (const Ray& other : rays) {
            widest = std::max(widest, angle_between(ray.direction, other.direction));
            farthest = std::max(farthest, double{length(ray.origin - other.origin)});
          }
        }
        // The smallest cone's half-angle is at least half the widest angle, and Szecsi's is less
        // than 1.6 times that.
        if (!bound.directions.whole()) {
          EXPECT_LE(half_angle(bound.directions), 0.5 * widest * 1.6 + 4e-6);
        } else {
          EXPECT_GE(widest, 1.2);
        }
        EXPECT_LE(bound.origins.radius, 0.5 * farthest * 1.6 + 1e-4);
      }
    }
  }
}

TEST(RayBound, ParentsHoldTheRaysOfTheirChildren) {
  Random random(2);
  for (const float spread : {1e-4f, 0.02f, 0.3f, 0.8f, 5.0f}) {
    for (int i = 0; i < 300; ++i) {
      const std::vector<Ray> rays = bundle(random, 64, spread, 2);
      std::vector<RayBound> leaves;
      for (std::size_t first = 0; first < 64; first += 8)
        leaves.push_back(bound_rays(View<const Ray>(rays).slice(first, 8)));
      const RayBound parent = bound_children(leaves);
      for (const Ray& ray : rays) ASSERT_TRUE(contains(parent, ray)) << "spread " << spread;
      double widest = 0;
      for (const Ray& a : rays)
        for (const Ray& b : rays)
          widest = std::max(widest, angle_between(a.direction, b.direction));
      if (widest < 1) {
        EXPECT_LE(half_angle(parent.directions), 0.5 * widest * 2.5 + 1e-5);
      }
    }
  }
}

TEST(RayBound, OppositeDirectionsNeedTheWholeSphere) {
  const std::vector<Ray> rays{{{0, 0, 0}, 0, {0, 0, 1}, 1}, {{0, 0, 0}, 0, {0, 0, -1}, 1}};
  EXPECT_TRUE(bound_rays(rays).directions.whole());
  const std::vector<RayBound> leaves{bound_rays(View<const Ray>(rays).slice(0, 1)),
                                     bound_rays(View<const Ray>(rays).slice(1, 1))};
  EXPECT_TRUE(bound_children(leaves).directions.whole());
}

TEST(RayBound, OneRayIsATightBound) {
  const std::vector<Ray> rays{{{1, 2, 3}, 0, {0, 3, 4}, 1}};
  const RayBound bound = bound_rays(rays);
  EXPECT_EQ(bound.origins.radius, 0);
  EXPECT_LT(bound.directions.sin_angle, 2e-6f);
}

TEST(Cone, UnionHoldsBothAndIsNotMuchLooserThanTheExactAngle) {
  Random random(4);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 axis = random.direction();
    const Cone a{axis, random.between(0, 0.6f)};
    const Cone b{random.direction_near(axis, 1), random.between(0, 0.6f)};
    const Vec3 merged = union_axis(a, b);
    const double td = angle_between(a.axis, b.axis), ta = half_angle(a), tb = half_angle(b);
    const double exact = std::max({ta, tb, (ta + tb + td) / 2});
    if (exact > 1.5) continue;
    const Cone result{merged, std::max(farthest_sine(merged, a), farthest_sine(merged, b))};
    EXPECT_GE(
        half_angle(result),
        std::max(angle_between(merged, a.axis) + ta, angle_between(merged, b.axis) + tb) - 2e-6);
    EXPECT_LE(half_angle(result), exact + 2e-3) << ta << " " << tb << " " << td;
  }
}

}  // namespace
}  // namespace raysheaf
