// The shapes of which the built-in scenes consist.
#include "scenes/shapes.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <set>

namespace raysheaf::builtin {
namespace {

/// Six times the volume; positive if front faces point outwards.
float six_volumes(const Mesh& mesh) {
  float sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c]));
  }
  return sum;
}

/// Whether each undirected edge has as many triangles in one direction as in the other.
bool is_closed(const Mesh& mesh) {
  using Point = std::array<float, 3>;
  std::map<std::pair<Point, Point>, int> edges;
  const auto point = [&](std::uint32_t v) {
    const Vec3 p = mesh.positions[v] + Vec3{0, 0, 0};
    return Point{p.x, p.y, p.z};
  };
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Point a = point(t[i]), b = point(t[(i + 1) % 3]);
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  return std::all_of(edges.begin(), edges.end(), [](const auto& e) { return e.second == 0; });
}

struct Solid {
  const char* name;
  std::function<void(MeshBuilder&)> add;
  std::size_t triangle_count;
  float volume, tolerance;
};

const std::array<Vec2, 5> kVase = {{{0, 0}, {1, 0}, {0.6f, 1}, {1, 2}, {0, 2}}};
const std::array<Vec3, 3> kStraight = {{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}};

std::vector<Solid> solids() {
  return {{"box",
           [](MeshBuilder& b) {
             add_box(b, {-1, 0, 2}, {1, 3, 2.5f});
           },
           12, 3, 1e-4f},
          {"rounded box",
           [](MeshBuilder& b) {
             add_rounded_box(b, {0, 0, 0}, {1, 2, 3}, 0.01f);
           },
           44, 6, 0.02f},
          {"rounder box",
           [](MeshBuilder& b) {
             add_rounded_box(b, {0, 0, 0}, {1, 2, 3}, 0.01f, 4);
           },
           332, 6, 0.02f},
          {"sphere",
           [](MeshBuilder& b) {
             add_sphere(b, {1, 2, 3}, 1, 64, 64);
           },
           2 * 64 * 63, 4.18879f, 0.02f},
          {"cylinder",
           [](MeshBuilder& b) {
             add_cylinder(b, {1, 2, 3}, 1, 2, 64);
           },
           4 * 64, 6.28319f, 0.02f},
          {"vase", [](MeshBuilder& b) { add_lathe(b, kVase, 64); }, 6 * 64, 4.10501f, 0.02f},
          {"prism", [](MeshBuilder& b) { add_prism(b, circle(1, 6), 2); }, 12 + 8, 5.19615f, 1e-3f},
          {"tube", [](MeshBuilder& b) { add_tube(b, kStraight, 0.1f, 0.1f, 64); }, 4 * 64 + 124,
           0.10883f, 1e-3f}};
}

TEST(Shapes, SolidsAreClosedAndHaveTheirVolume) {
  for (const Solid& solid : solids()) {
    MeshBuilder builder(solid.name);
    solid.add(builder);
    const Mesh mesh = builder.take();
    EXPECT_EQ(mesh.triangles.size(), solid.triangle_count) << solid.name;
    EXPECT_TRUE(is_closed(mesh)) << solid.name;
    EXPECT_NEAR(six_volumes(mesh) / 6, solid.volume, solid.tolerance) << solid.name;
  }
}

TEST(Shapes, MirroringFramesKeepFrontFacesOutside) {
  for (const Solid& solid : solids()) {
    MeshBuilder builder(solid.name);
    builder.at(compose(translation({5, -3, 2}), scaling({-1, 1, 1})));
    solid.add(builder);
    const Mesh mesh = builder.take();
    EXPECT_NEAR(six_volumes(mesh) / 6, solid.volume, solid.tolerance + 1e-3f) << solid.name;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 face =
          cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
      for (const std::uint32_t v : {a, b, c})
        ASSERT_GT(dot(face, mesh.normals[v]), 0) << solid.name;
    }
  }
}

TEST(Shapes, SphereNormalsPointFromItsCenter) {
  const Vec3 center{4, -2, 1};
  MeshBuilder builder("sphere");
  add_sphere(builder, center, 0.5f, 24, 16);
  const Mesh mesh = builder.take();
  EXPECT_EQ(mesh.triangles.size(), 720u);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_LT(length(mesh.normals[i] - (mesh.positions[i] - center) / 0.5f), 1e-4f);
  }
}

TEST(Shapes, MouldingFacesAwayFromItsWall) {
  const std::array<Vec2, 4> outline = {{{0, 0}, {0, 0.1f}, {0.2f, 0.1f}, {0.2f, 0}}};
  MeshBuilder builder("moulding");
  add_moulding(builder, 2, 1, outline);
  const Mesh mesh = builder.take();
  EXPECT_EQ(mesh.triangles.size(), 4u * 4 * 2);
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_NEAR(six_volumes(mesh) / 6, 0.1f * (2.4f * 1.4f - 2), 1e-4f);
}

TEST(Shapes, SurfacesFaceWhereTheyShould) {
  MeshBuilder builder("surface");
  add_surface(builder, 4, 3, [](float u, float v) { return Vec3{u, v, u * v}; });
  const Mesh mesh = builder.take();
  EXPECT_EQ(mesh.triangles.size(), 24u);
  for (const Vec3 n : mesh.normals) EXPECT_GT(n.z, 0.5f);
}

TEST(MeshBuilder, OneMaterialIsWrittenOnce) {
  MeshBuilder builder("box");
  builder.use(3);
  add_box(builder, {0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(builder.take().materials, std::vector<std::uint32_t>{3});
  builder.use(1);
  add_box(builder, {0, 0, 0}, {1, 1, 1});
  builder.use(2);
  add_box(builder, {2, 0, 0}, {3, 1, 1});
  const Mesh mesh = builder.take();
  ASSERT_EQ(mesh.materials.size(), 24u);
  EXPECT_EQ(mesh.materials[11], 1u);
  EXPECT_EQ(mesh.materials[12], 2u);
}

TEST(Random, StaysInItsIntervalAndCoversIt) {
  Random random(1), same(1), other(2);
  std::set<std::uint32_t> values;
  for (int i = 0; i < 1000; ++i) {
    const float x = random.uniform(-2, 3);
    EXPECT_GE(x, -2);
    EXPECT_LT(x, 3);
    EXPECT_EQ(x, same.uniform(-2, 3));
    values.insert(static_cast<std::uint32_t>((x + 2) * 2));
  }
  EXPECT_EQ(values.size(), 10u);
  EXPECT_NE(random.next(), other.next());
}

}  // namespace
}  // namespace raysheaf::builtin
