// Rays that leave a surface do not hit it again, and do hit nearby surfaces.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "geom/surface_body.h"
#include "intersect/triangle_body.h"
#include "render/rays/shadow_body.h"
#include "support/random.h"

namespace raysheaf {
namespace {

struct Corners {
  Vec3 a, b, c;

  [[nodiscard]] bool is_met(const Ray& ray) const {
    TriangleHit hit;
    return intersect_triangle(make_ray_setup(ray), a, b, c, &hit);
  }
  /// The normal of the front, or zero.
  [[nodiscard]] Vec3 normal() const {
    const Vec3 corner[3] = {a, b, c};
    return front_normal(corner, false);
  }
  /// `margin` scales the allowance for the test's rounding errors.
  [[nodiscard]] Surface at(float u, float v, float margin = 1) const {
    MixedPoint point = mixed_point(a, b, c, u, v);
    point.reach *= margin;
    Surface surface;
    surface.position = point.position;
    surface.geometric_normal = surface.normal = normal();
    surface.clearance = clearance(point, surface.normal);
    return surface;
  }
};

/// A triangle of any size, shape and place: floors, needles, far from the origin.
Corners some_triangle(test::Random& random) {
  const float size = std::pow(10.0f, 8 * random.unit() - 4);
  const Vec3 a = random.in_box(size * (random.below(2) == 0 ? 0.0f : 100.0f));
  Vec3 along = random.in_box(size), across = random.in_box(size);
  if (random.below(4) == 0) across = along * random.unit() + across * 1e-2f;
  if (random.below(4) == 0) along.y = across.y = 0;
  return {a, a + along, a + across};
}

/// A direction on the normal's side; every other one is nearly parallel to the surface.
Vec3 some_way_up(test::Random& random, Vec3 normal) {
  Vec3 way = random.direction();
  const float up = dot(way, normal);
  if (random.below(2) == 0) return up < 0 ? -way : way;
  way = way + normal * (std::pow(10.0f, -4 * random.unit()) - up);
  return normalized(way);
}

TEST(Offset, HalfOfItKeepsRaysOffTheirTriangleAndItsCoplanarNeighbour) {
  constexpr float kHalf = 0.5f;
  test::Random random(5);
  int rays = 0;
  for (int round = 0; round < 400000; ++round) {
    const Corners own = some_triangle(random);
    const Vec3 normal = own.normal();
    if (normal == Vec3{0, 0, 0}) continue;
    float u = random.unit(), v = random.unit();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    if (random.below(5) == 0) u = 0;
    if (random.below(5) == 0) v = 0;
    const Surface surface = own.at(u, v, kHalf);
    const Vec3 way = some_way_up(random, normal);
    if (!(dot(way, normal) > 0)) continue;
    // The other half of a parallelogram: coplanar except for its corner's rounding.
    const Corners beside{own.c, own.b, own.b + (own.c - own.a)};
    const Ray leaving{offset_point(surface, way, 0), 0, way};
    ASSERT_FALSE(own.is_met(leaving)) << round;
    ASSERT_FALSE(beside.is_met(leaving)) << round;
    const float far = length(own.b - own.a) * std::pow(10.0f, 4 * random.unit() - 2);
    const Vec3 light = surface.position + way * far;
    const Vec3 target = offset_point(surface, way, kHalf * far);
    ++rays;
    if (!(dot(light - target, normal) > 0)) continue;  // below the surface by rounding
    ASSERT_FALSE(own.is_met({light, 0, target - light, 1})) << round;
  }
  EXPECT_GT(rays, 300000);
}

/// A roof at a tenth above a floor, both with this half size, at any place; the sun is at one side.
void expect_shadow(float half, Vec3 center) {
  SCOPED_TRACE(std::to_string(half) + " at " + std::to_string(center.x));
  const auto at = [&](float x, float y, float z) { return center + Vec3{x, y, z}; };
  const Corners floor[2] = {{at(-half, 0, -half), at(-half, 0, half), at(half, 0, -half)},
                            {at(half, 0, half), at(half, 0, -half), at(-half, 0, half)}};
  const float size = 0.05f, up = 0.05f;
  const Corners roof[2] = {{at(-size, up, -size), at(-size, up, size), at(size, up, -size)},
                           {at(size, up, size), at(size, up, -size), at(-size, up, size)}};
  const Box bounds{at(-half, 0, -half), at(half, up, half)};
  LightSample sun;
  sun.to_light = normalized({0.3f, 1, 0.2f});
  sun.distance = std::numeric_limits<float>::infinity();
  sun.irradiance = {1, 1, 1};
  test::Random random(6);
  int dark = 0, rays = 0;
  while (rays < 1000) {
    const Vec3 place = random.in_box(0.1f);
    const float x = place.x / half, z = place.z / half;
    const bool first = x + z < 0;
    // Corner b is along z, c along x; the other half has them swapped.
    const float u = first ? (1 + z) / 2 : (1 - z) / 2, v = first ? (1 + x) / 2 : (1 - x) / 2;
    Fragment f;
    f.surface = floor[first ? 0 : 1].at(u, v);
    const Vec3 p = f.surface.position - center;
    const float rise = up / sun.to_light.y;
    const float rx = std::fabs(p.x + sun.to_light.x * rise) - size;
    const float rz = std::fabs(p.z + sun.to_light.z * rise) - size;
    const float edge = rx > rz ? rx : rz;
    if (std::fabs(edge) < 0.02f) continue;
    const Ray ray = shadow_ray(f, sun, light_reach(bounds));
    const bool is_met = roof[0].is_met(ray) || roof[1].is_met(ray);
    EXPECT_EQ(is_met, edge < 0) << p.x << " " << p.z;
    for (const Corners& triangle : floor) EXPECT_FALSE(triangle.is_met(ray));
    dark += is_met ? 1 : 0;
    ++rays;
  }
  EXPECT_GT(dark, 50);
}

TEST(Offset, SmallThingsShadeLargeFloorsAndFarOnes) {
  for (const float half : {1.0f, 100.0f, 1e3f, 1e4f}) expect_shadow(half, {0, 0, 0});
  for (const float far : {2048.0f, 32768.0f, 65536.0f}) expect_shadow(5, {far, far, far});
}

TEST(Offset, GrowsOnlyWithRoundingErrors) {
  const Corners floor{{-10, 0, -10}, {-10, 0, 10}, {10, 0, -10}};
  EXPECT_LT(floor.at(0.25f, 0.25f).clearance, 2e-6f);
  const Vec3 far{1e5f, 1e5f, 1e5f};
  const Corners there{floor.a + far, floor.b + far, floor.c + far};
  EXPECT_LT(there.at(0.25f, 0.25f).clearance, 0.013f);
}

}  // namespace
}  // namespace raysheaf
