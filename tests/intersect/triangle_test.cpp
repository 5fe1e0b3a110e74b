#include "intersect/triangle_body.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <vector>

#include "support/random.h"

namespace raysheaf {
namespace {

using test::Random;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct SphereMesh {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// An octahedron whose faces are split in four `steps` times, with vertices moved to the unit
/// sphere.
SphereMesh sphere_mesh(int steps) {
  SphereMesh mesh{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int step = 0; step < steps; ++step) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [place, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.points.size()));
      if (is_new) mesh.points.push_back(normalized(mesh.points[a] + mesh.points[b]));
      return place->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& t : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        finer.push_back(t);
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

bool meets_any(const SphereMesh& mesh, const Ray& ray) {
  const RaySetup setup = make_ray_setup(ray);
  TriangleHit hit;
  for (const auto& [a, b, c] : mesh.triangles)
    if (intersect_triangle(setup, mesh.points[a], mesh.points[b], mesh.points[c], &hit))
      return true;
  return false;
}

TEST(Triangle, NoRayPassesThroughAClosedMeshAtItsEdgesAndVertices) {
  const SphereMesh unit = sphere_mesh(3);
  for (const float scale : {1.0f, 1e-3f, 1e3f, 1e-19f, 1e18f}) {
    for (const Vec3 shift : {Vec3{0, 0, 0}, Vec3{37.25f, -11.5f, 93.125f}}) {
      SphereMesh mesh = unit;
      for (Vec3& p : mesh.points) p = (p + shift) * scale;
      Random random(7);
      for (int i = 0; i < 400; ++i) {
        const auto& t =
            mesh.triangles[random.below(static_cast<std::uint32_t>(mesh.triangles.size()))];
        const Vec3 a = mesh.points[t[0]], b = mesh.points[t[1]];
        const Vec3 inside = (random.in_box(0.4f) + shift) * scale;
        const Vec3 target = i % 2 == 0 ? a : lerp(a, b, random.unit());
        ASSERT_TRUE(meets_any(mesh, {inside, 0, target - inside, kInfinity}))
            << "scale " << scale << " shift " << shift.x << " ray " << i;
      }
    }
  }
}

/// A well-conditioned reference in binary64 (Möller and Trumbore 1997).
bool reference_hit(const Ray& ray, Vec3 a, Vec3 b, Vec3 c, double* t, double* u, double* v) {
  const auto sub = [](Vec3 p, Vec3 q) {
    return std::array<double, 3>{double{p.x} - q.x, double{p.y} - q.y, double{p.z} - q.z};
  };
  using A = std::array<double, 3>;
  const auto crossd = [](A p, A q) {
    return A{p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
  };
  const auto dotd = [](A p, A q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; };
  const A d{ray.direction.x, ray.direction.y, ray.direction.z};
  const A ab = sub(b, a), ac = sub(c, a), from = sub(ray.origin, a);
  const A p = crossd(d, ac), q = crossd(from, ab);
  const double det = dotd(ab, p);
  *u = dotd(from, p) / det;
  *v = dotd(d, q) / det;
  *t = dotd(ac, q) / det;
  return *u >= 0 && *v >= 0 && *u + *v <= 1 && *t >= ray.t_min && *t <= ray.t_max;
}

TEST(Triangle, AgreesWithBinary64AwayFromEdges) {
  Random random(3);
  int hits = 0;
  for (int i = 0; i < 200000; ++i) {
    const Vec3 a = random.in_box(3), b = random.in_box(3), c = random.in_box(3);
    const Ray ray{random.in_box(5), 0, random.direction() * random.between(0.1f, 4), kInfinity};
    double t, u, v;
    const bool expected = reference_hit(ray, a, b, c, &t, &u, &v);
    const double margin = std::min({std::abs(u), std::abs(v), std::abs(1 - u - v), std::abs(t)});
    const float facing = std::fabs(dot(normalized(cross(b - a, c - a)), normalized(ray.direction)));
    if (margin < 1e-4 || facing < 0.05f || length(cross(b - a, c - a)) < 0.1f) continue;
    TriangleHit hit{};
    ASSERT_EQ(intersect_triangle(make_ray_setup(ray), a, b, c, &hit), expected) << i;
    if (!expected) continue;
    ++hits;
    EXPECT_NEAR(hit.t, t, 1e-4 * (1 + t));
    EXPECT_NEAR(hit.u, u, 1e-4);
    EXPECT_NEAR(hit.v, v, 1e-4);
    EXPECT_EQ(hit.front, dot(cross(b - a, c - a), ray.direction) < 0);
  }
  EXPECT_GT(hits, 1000);
}

TEST(Triangle, TheNearerOfTwoIsNearerAtEveryScale) {
  for (const float scale : {1e-20f, 1e-12f, 1e-3f, 1.0f, 1e6f, 1e13f, 1e18f}) {
    const auto corner = [&](float x, float y, float z) { return Vec3{x, y, z} * scale; };
    const RaySetup ray = make_ray_setup({corner(0.1f, 0.2f, 3), 0, {0, 0, -1}, kInfinity});
    TriangleHit near{}, far{};
    ASSERT_TRUE(
        intersect_triangle(ray, corner(-1, -1, 1), corner(1, -1, 1), corner(0, 1, 1), &near));
    ASSERT_TRUE(
        intersect_triangle(ray, corner(-1, -1, 0), corner(1, -1, 0), corner(0, 1, 0), &far));
    EXPECT_NEAR(near.t / scale, 2, 1e-5f) << scale;
    EXPECT_NEAR(far.t / scale, 3, 1e-5f) << scale;
    // Corners on both sides of the origin.
    EXPECT_TRUE(
        intersect_triangle(ray, corner(-4, -4, 5), corner(4, -4, 5), corner(0, 4, -3), &far));
  }
}

TEST(Triangle, BothTrianglesOwnTheirSharedEdge) {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{1, 1, 0}, d{0, 1, 0};
  const RaySetup ray = make_ray_setup({{0.5f, 0.5f, 1}, 0, {0, 0, -1}, kInfinity});
  TriangleHit hit;
  EXPECT_TRUE(intersect_triangle(ray, a, b, c, &hit));
  EXPECT_TRUE(intersect_triangle(ray, a, c, d, &hit));
}

TEST(Triangle, KeepsToTheInterval) {
  const Vec3 a{-1, -1, 0}, b{1, -1, 0}, c{0, 1, 0};
  TriangleHit hit;
  const auto meets = [&](float t_min, float t_max) {
    return intersect_triangle(make_ray_setup({{0, 0, 2}, t_min, {0, 0, -1}, t_max}), a, b, c, &hit);
  };
  EXPECT_TRUE(meets(0, 2));
  EXPECT_TRUE(meets(2, 3));
  EXPECT_FALSE(meets(0, 1.999f));
  EXPECT_FALSE(meets(2.001f, 3));
  EXPECT_FALSE(
      intersect_triangle(make_ray_setup({{0, 0, 2}, 0, {0, 0, 1}, kInfinity}), a, b, c, &hit));
}

TEST(Triangle, TCountsInLengthsOfTheDirection) {
  TriangleHit hit{};
  ASSERT_TRUE(intersect_triangle(make_ray_setup({{0, 0, 8}, 0, {0, 0, -4}, kInfinity}), {-1, -1, 0},
                                 {1, -1, 0}, {0, 1, 0}, &hit));
  EXPECT_EQ(hit.t, 2);
  EXPECT_EQ(hit.u, 0.25f);
  EXPECT_EQ(hit.v, 0.5f);
}

TEST(Triangle, ZeroAreaIsNeverMet) {
  Random random(5);
  TriangleHit hit;
  for (int i = 0; i < 10000; ++i) {
    const Vec3 a = random.in_box(2), b = random.in_box(2);
    const Vec3 origin = random.in_box(5);
    const RaySetup ray = make_ray_setup({origin, 0, lerp(a, b, random.unit()) - origin, kInfinity});
    EXPECT_FALSE(intersect_triangle(ray, a, b, b, &hit));
    EXPECT_FALSE(intersect_triangle(ray, a, a, b, &hit));
    EXPECT_FALSE(intersect_triangle(ray, a, a, a, &hit));
  }
}

TEST(Triangle, NotANumberIsNeverMet) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  TriangleHit hit;
  const RaySetup ray = make_ray_setup({{0, 0, 1}, 0, {0, 0, -1}, kInfinity});
  EXPECT_FALSE(intersect_triangle(ray, {nan, 0, 0}, {1, 0, 0}, {0, 1, 0}, &hit));
}

}  // namespace
}  // namespace raysheaf
