#include "paper/packets/frustum_body.h"

#include <gtest/gtest.h>

#include "intersect/triangle_body.h"
#include "paper/packets/packets.h"
#include "support/random.h"

namespace raysheaf {
namespace {

using test::Random;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct FrustumBundle {
  std::vector<Ray> rays;
  PacketFrustum frustum;
};

int axis_of(const Ray& ray) {
  return static_cast<int>(dominant_sense(ray.direction) / 2);
}

/// Rays with the same signs around a common direction, from a point or from a patch.
FrustumBundle random_bundle(Random& random, const Box& scene, Vec3 place, float size) {
  FrustumBundle bundle;
  const Vec3 axis = random.direction();
  const Vec3 origin = place + random.in_box(size * 1.5f);
  const float spread = random.below(3) == 0 ? 0.5f : random.between(0, 0.05f);
  const float patch = random.below(2) == 0 ? 0 : size * random.between(0, 0.3f);
  const std::uint32_t count = random.below(3) == 0 ? 1 : 1 + random.below(12);
  while (bundle.rays.size() < count) {
    const Vec3 direction = random.direction_near(axis, spread) * random.between(0.1f, 10) * size;
    if (!bundle.rays.empty() &&
        dominant_sense(direction) != dominant_sense(bundle.rays[0].direction)) {
      if (random.below(8) == 0) break;
      continue;
    }
    const float t_min = random.below(2) == 0 ? 0 : random.between(0, 0.5f);
    float t_max = random.below(2) == 0 ? kInfinity : t_min + random.between(0, 2);
    if (random.below(3) == 0) t_max = t_min + 1e-4f * random.unit();
    bundle.rays.push_back({origin + random.in_box(patch), t_min, direction, t_max});
  }
  std::vector<RayEnd> ends(2 * bundle.rays.size());
  bundle.frustum = bound_packet(bundle.rays, axis_of(bundle.rays[0]), scene, ends);
  return bundle;
}

struct Corners {
  Vec3 a, b, c;
};

/// A large triangle whose box begins within rounding errors of a point: an edge passes there, in a
/// plane perpendicular to an axis.
Corners grazing_triangle(Random& random, Vec3 p, float size) {
  Corners t{p + random.in_box(size), p, p};
  t.b = p + (p - t.a) * random.unit();
  t.c = p + random.in_box(size);
  const auto pull = [&](float at, float* a, float* b, float* c) {
    *a = *b = at + random.between(-1, 1) * random.unit() * 2e-7f * size;
    *c = at + std::fabs(*c - at) * (random.below(2) == 0 ? 1.0f : -1.0f);
  };
  const std::uint32_t axis = random.below(3);
  if (axis == 0) pull(p.x, &t.a.x, &t.b.x, &t.c.x);
  if (axis == 1) pull(p.y, &t.a.y, &t.b.y, &t.c.y);
  if (axis == 2) pull(p.z, &t.a.z, &t.b.z, &t.c.z);
  return t;
}

/// A triangle that the ray hits, one near it, or one anywhere, of any size and shape.
Corners random_triangle(Random& random, const Ray& ray, Vec3 place, float size) {
  if (random.below(4) == 0)
    return {place + random.in_box(size), place + random.in_box(size), place + random.in_box(size)};
  const float t = ray.t_min + random.unit() * (random.below(2) == 0 ? 0.1f : 2.0f);
  const Vec3 p = ray.origin + ray.direction * std::fmin(t, ray.t_max);
  if (random.below(2) == 0) return grazing_triangle(random, p, size);
  const float extent = size * std::exp2(random.between(-12, 0));
  const Vec3 a = random.below(3) == 0 ? p : p + random.in_box(extent);
  const Vec3 b = p + random.in_box(extent);
  const Vec3 c = random.below(4) == 0 ? a + (b - a) * random.unit() + random.in_box(1e-4f * extent)
                                      : p + random.in_box(extent);
  return {a, b, c};
}

Box box_of(const Corners& t) {
  return {min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c)};
}

bool hit(const Ray& ray, const Corners& t) {
  TriangleHit where{};
  return intersect_triangle(make_ray_setup(ray), t.a, t.b, t.c, &where);
}

/// Around `place`, with objects of about `size`: no triangle that a ray hits is culled.
void expect_conservative(std::uint64_t seed, Vec3 place, float size, int triples, int* hits) {
  Random random(seed);
  const Vec3 half{size * 3, size * 3, size * 3};
  const Box scene{place - half, place + half};
  for (int n = 0; n < triples;) {
    const FrustumBundle bundle = random_bundle(random, scene, place, size);
    for (int k = 0; k < 10; ++k) {
      const Ray& ray = bundle.rays[random.below(static_cast<std::uint32_t>(bundle.rays.size()))];
      const Corners t = random_triangle(random, ray, place, size);
      const Box box = box_of(t);
      if (min_component(box.min - scene.min) < 0 || min_component(scene.max - box.max) < 0)
        continue;
      ++n;
      if (meets(bundle.frustum, t.a, t.b, t.c)) {
        ASSERT_TRUE(meets(bundle.frustum, box.min, box.max));
      }
      for (const Ray& each : bundle.rays) {
        if (!hit(each, t)) continue;
        ++*hits;
        ASSERT_TRUE(meets(bundle.frustum, t.a, t.b, t.c)) << "seed " << seed << " triple " << n;
        ASSERT_TRUE(meets(bundle.frustum, box.min, box.max)) << "seed " << seed << " triple " << n;
      }
    }
  }
}

TEST(PacketFrustum, NeverRefusesWhatARayHits) {
  int hits = 0;
  expect_conservative(1, {0, 0, 0}, 10, 100000, &hits);
  expect_conservative(2, {1e5f, -2e5f, 3e5f}, 10, 20000, &hits);
  expect_conservative(3, {0, 0, 0}, 1e-12f, 20000, &hits);
  expect_conservative(4, {0, 0, 0}, 1e10f, 20000, &hits);
  EXPECT_GT(hits, 30000);
}

TEST(PacketFrustum, IsTightAroundAFan) {
  // From a point, with slopes up to 0.1: objects at slope 0.11, behind, and beyond are culled.
  std::vector<Ray> rays;
  for (int i = -10; i <= 10; ++i)
    for (int k = -10; k <= 10; ++k)
      rays.push_back(
          {{0, 0, 0}, 0, {static_cast<float>(i) * 0.01f, static_cast<float>(k) * 0.01f, 1}, 50});
  const Box scene{{-100, -100, -100}, {100, 100, 100}};
  std::vector<RayEnd> ends(2 * rays.size());
  const PacketFrustum f = bound_packet(rays, 2, scene, ends);
  const auto meets_at = [&f](Vec3 p) {
    const Vec3 e{0.01f, 0.01f, 0.01f};
    return meets(f, p - e, p + e);
  };
  for (const float z : {1.0f, 10.0f, 40.0f}) {
    EXPECT_TRUE(meets_at({0.1f * z, 0, z}));
    EXPECT_TRUE(meets_at({-0.1f * z, -0.1f * z, z}));
    for (const float s : {-1.0f, 1.0f}) {
      EXPECT_FALSE(meets_at({s * (0.11f * z + 0.05f), 0, z})) << z;
      EXPECT_FALSE(meets_at({0, s * (0.11f * z + 0.05f), z})) << z;
    }
  }
  EXPECT_FALSE(meets_at({0, 0, -0.1f}));
  EXPECT_FALSE(meets_at({0, 0, 50.1f}));
}

TEST(PacketFrustum, TakesTheShapeOfAConvergingBundle) {
  std::vector<Ray> rays;
  for (const float x : {-1.0f, 1.0f})
    for (const float y : {-1.0f, 1.0f}) rays.push_back({{x, y, 0}, 0, {-x, -y, 10}, 1});
  const Box scene{{-20, -20, -20}, {20, 20, 20}};
  std::vector<RayEnd> ends(2 * rays.size());
  const PacketFrustum f = bound_packet(rays, 2, scene, ends);
  EXPECT_TRUE(meets(f, {0.9f, -0.1f, 0.5f}, {1, 0.1f, 0.6f}));
  EXPECT_FALSE(meets(f, {0.3f, -0.1f, 9}, {1, 0.1f, 9.5f}));
}

TEST(PacketFrustum, AnUnboundedRayMeetsEveryTriangle) {
  const Box scene{{-1, -1, -1}, {1, 1, 1}};
  const std::vector<Ray> rays{{{0, 0, 0}, 0, {1e-44f, 0, 0}, kInfinity}};
  std::vector<RayEnd> ends(2);
  const PacketFrustum f = bound_packet(rays, 0, scene, ends);
  EXPECT_TRUE(meets(f, {0.5f, -0.1f, -0.1f}, {0.6f, 0.1f, 0.1f}));
}

}  // namespace
}  // namespace raysheaf
