#include "paper/ray_hierarchy/cone_sphere_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "paper/ray_hierarchy/node_filter.h"
#include "support/random.h"
#include "support/simd_targets.h"

namespace raysheaf {
namespace {

using test::Random;

std::vector<Ray> random_bundle(Random& random, float scale) {
  const Vec3 axis = random.direction(), center = random.in_box(10) * scale;
  const float spread = std::pow(10.0f, random.between(-5, 0.3f));
  const float extent = random.below(3) == 0 ? 0 : scale * std::pow(10.0f, random.between(-4, 0.5f));
  std::vector<Ray> rays;
  for (int i = 0; i < 8; ++i)
    rays.push_back({center + random.in_box(extent), 0, random.direction_near(axis, spread), 1});
  return rays;
}

/// The distance from a point to the ray, in binary64.
double distance(const Ray& ray, Vec3 point) {
  const double d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  const double v[3] = {double{point.x} - ray.origin.x, double{point.y} - ray.origin.y,
                       double{point.z} - ray.origin.z};
  const double along =
      (v[0] * d[0] + v[1] * d[1] + v[2] * d[2]) / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double rest = v[k] - std::max(along, 0.0) * d[k];
    squared += rest * rest;
  }
  return std::sqrt(squared);
}

TEST(ConeSphere, NoBallThatARayTouchesIsRejected) {
  Random random(9);
  for (const float scale : {1.0f, 1e-6f, 1e6f, 1e-25f, 1e17f}) {
    for (int i = 0; i < 100000; ++i) {
      const std::vector<Ray> rays = random_bundle(random, scale);
      const ConeSphereTest node = make_cone_sphere_test(bound_rays(rays));
      const Ray& ray = rays[random.below(8)];
      // A sphere that just reaches the ray at some point.
      const float t = scale * std::pow(10.0f, random.between(-3, 2));
      const float radius =
          random.below(4) == 0 ? 0 : scale * std::pow(10.0f, random.between(-5, 1));
      const Vec3 center = ray.origin + ray.direction * t + random.direction() * radius;
      const auto reach = static_cast<float>(distance(ray, center));
      ASSERT_TRUE(meets(node, center, std::nextafter(reach, 1e30f)))
          << "scale " << scale << " " << i;
    }
  }
}

/// The exact distance test in binary64 (in the half plane of the header's drawing).
bool reference_meets(const RayBound& bound, const Sphere& sphere, double slack) {
  const double px = double{sphere.center.x} - bound.origins.center.x,
               py = double{sphere.center.y} - bound.origins.center.y,
               pz = double{sphere.center.z} - bound.origins.center.z;
  const Vec3 x = bound.directions.axis;
  const double a = px * x.x + py * x.y + pz * x.z, vv = px * px + py * py + pz * pz;
  const double b = std::sqrt(std::max(0.0, vv - a * a)),
               r = bound.origins.radius + double{sphere.radius};
  const double sine = bound.directions.sin_angle, cosine = std::sqrt(1 - sine * sine);
  const double s = b * cosine - a * sine, e = a * cosine + b * sine;
  const double distance = s <= 0 && e >= 0 ? 0 : (e >= 0 ? s : std::sqrt(vv));
  return distance <= r + slack * (std::sqrt(vv) + r);
}

TEST(ConeSphere, IsAsTightAsTheExactTest) {
  Random random(10);
  int rejected = 0, accepted = 0;
  for (int i = 0; i < 200000; ++i) {
    const RayBound bound = bound_rays(random_bundle(random, 1));
    if (bound.directions.whole()) continue;
    const Sphere sphere{random.in_box(20), random.between(0, 1)};
    const bool hit = meets(make_cone_sphere_test(bound), sphere.center, sphere.radius);
    (hit ? accepted : rejected)++;
    if (reference_meets(bound, sphere, 0)) {
      ASSERT_TRUE(hit) << i;
    }
    if (hit) {
      ASSERT_TRUE(reference_meets(bound, sphere, 2e-5)) << i;
    }
  }
  EXPECT_GT(rejected, 10000);
  EXPECT_GT(accepted, 2000);
}

TEST(ConeSphere, BallsBehindTheOriginsAreRejected) {
  const std::vector<Ray> rays{{{0, 0, 0}, 0, {0, 0, 1}, 1}, {{0, 0, 0}, 0, {0.01f, 0, 1}, 1}};
  const ConeSphereTest node = make_cone_sphere_test(bound_rays(rays));
  EXPECT_FALSE(meets(node, {0, 0, -5}, 1));
  EXPECT_TRUE(meets(node, {0, 0, 5}, 1));
  EXPECT_TRUE(meets(node, {0, 0, -0.5f}, 1));
}

TEST(NodeFilter, EveryTargetAcceptsWhatTheScalarTestAccepts) {
  Random random(12);
  for (const std::uint32_t count : {0u, 1u, 15u, 16u, 17u, 1000u}) {
    const RayBound bound = bound_rays(random_bundle(random, 1));
    const ConeSphereTest node = make_cone_sphere_test(bound);
    std::vector<float> x, y, z, r;
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3 c = random.in_box(20);
      x.push_back(c.x), y.push_back(c.y), z.push_back(c.z), r.push_back(random.between(0, 3));
      if (meets(node, c, r.back())) expected.push_back(i);
    }
    test::for_each_simd_target([&](const char* target) {
      std::vector<std::uint32_t> out(count + 16);
      out.resize(filter(node, {x.data(), y.data(), z.data(), r.data()}, count, out.data()));
      EXPECT_EQ(out, expected) << target << " " << count;
      std::vector<float> gathered(out.size());
      gather_floats(x.data(), out.data(), static_cast<std::uint32_t>(out.size()), gathered.data());
      for (std::size_t i = 0; i < out.size(); ++i) EXPECT_EQ(gathered[i], x[out[i]]) << target;
    });
  }
}

TEST(NodeFilter, ANodeOfAllDirectionsMeetsEverything) {
  const ConeSphereTest node = make_cone_sphere_test({{{0, 0, 0}, 1}, Cone{}});
  const std::vector<float> zeros(20), far(20, 1e30f);
  std::vector<std::uint32_t> out(36);
  EXPECT_EQ(filter(node, {far.data(), zeros.data(), zeros.data(), zeros.data()}, 20, out.data()),
            20u);
}

}  // namespace
}  // namespace raysheaf
