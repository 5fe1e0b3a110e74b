#include <gtest/gtest.h>

#include <cmath>

#include "base/float.h"
#include "intersect/triangle_body.h"
#include "support/random.h"

namespace raysheaf {
namespace {

using test::Random;

/// The ends of ray bundles rely on this (geom/ray_end.h).
TEST(Triangle, HitsOfTrianglesSeenEdgeOnLieAtTheTriangle) {
  Random random(31);
  int hits = 0;
  for (int i = 0; i < 2000000; ++i) {
    const Vec3 a = random.in_box(10), b = a + random.in_box(8);
    Vec3 c = a + random.in_box(8);
    if (i % 2 == 0)
      c = lerp(a, b, random.unit()) + random.in_box(std::pow(10.0f, random.between(-6, 0)));
    const Vec3 p = lerp(lerp(a, b, random.unit()), c, random.unit());
    const Vec3 q = lerp(lerp(a, b, random.unit()), c, random.unit());
    const Ray ray{p + (p - q) * random.between(0, 3), 0, q - p,
                  std::numeric_limits<float>::infinity()};
    TriangleHit hit;
    if (!intersect_triangle(make_ray_setup(ray), a, b, c, &hit)) continue;
    ++hits;
    const Vec3 at = ray.origin + ray.direction * hit.t;
    const Vec3 outside = max(min(min(a, b), c) - at, at - max(max(a, b), c));
    const Vec3 o = ray.origin;
    const float farthest = max_component(max(max(abs(a - o), abs(b - o)), abs(c - o)));
    ASSERT_LE(max_component(outside), 40 * kUnitRoundoff * farthest) << i;
  }
  EXPECT_GT(hits, 500000);
}

}  // namespace
}  // namespace raysheaf
