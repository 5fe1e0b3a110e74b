// Computed vertex normals have unit length, are weighted by area, and have creases at 60 degrees.
#include "io/normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace raysheaf::io {
namespace {

double inner(Vec3 a, Vec3 b) {
  return double{a.x} * b.x + double{a.y} * b.y + double{a.z} * b.z;
}

/// Two rectangles of widths 1 and `width` that share the y axis, the second rotated up by `angle`.
Mesh roof(double angle, float width) {
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  Mesh mesh;
  mesh.positions = {{-1, 0, 0},
                    {0, 0, 0},
                    {0, 1, 0},
                    {-1, 1, 0},
                    {width * c, 0, width * s},
                    {width * c, 1, width * s}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};
  return mesh;
}

TEST(Normals, AreWeightedByAreaAcrossGentleEdges) {
  const double angle = 0.8;
  Mesh mesh = roof(angle, 3);
  add_missing_normals(mesh);
  EXPECT_EQ(mesh.positions.size(), 6u) << "nothing to split";
  // Vertex 2 touches both triangles of the first rectangle and one of the second: areas 1 and 1.5.
  const double x = -1.5 * std::sin(angle), z = 1 + 1.5 * std::cos(angle);
  EXPECT_NEAR(mesh.normals[2].x, x / std::hypot(x, z), 1e-6);
  EXPECT_NEAR(mesh.normals[2].z, z / std::hypot(x, z), 1e-6);
}

TEST(Normals, SplitVerticesAtCreases) {
  for (const double degrees : {59.0, 61.0}) {
    Mesh mesh = roof(degrees * 3.14159265358979 / 180, 1);
    const Mesh before = mesh;
    const std::vector<std::uint32_t> copied = add_missing_normals(mesh);
    EXPECT_EQ(mesh.positions.size(), degrees < 60 ? 6u : 8u) << degrees;
    ASSERT_EQ(copied.size(), mesh.positions.size() - before.positions.size());
    for (std::size_t i = 0; i < copied.size(); ++i) {
      ASSERT_LT(copied[i], before.positions.size() + i);
      EXPECT_EQ(mesh.positions[copied[i]].y, mesh.positions[before.positions.size() + i].y);
    }
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 a = mesh.positions[mesh.triangles[t][k]];
        const Vec3 b = before.positions[before.triangles[t][k]];
        EXPECT_TRUE(a.x == b.x && a.y == b.y && a.z == b.z) << "corners stay where they were";
      }
    }
  }
}

TEST(Normals, CountPositionsNotIndices) {
  Mesh mesh = roof(0.5, 1);
  // The same roof without shared vertices.
  Mesh apart;
  for (const auto& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.positions.size());
    for (const std::uint32_t v : t) apart.positions.push_back(mesh.positions[v]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  add_missing_normals(mesh);
  add_missing_normals(apart);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(inner(mesh.normals[mesh.triangles[t][k]], apart.normals[apart.triangles[t][k]]),
                  1, 1e-6);
    }
  }
}

TEST(Normals, KeepThoseThatAreGiven) {
  Mesh mesh = roof(1.5, 1);
  mesh.normals.assign(6, {1, 0, 0});
  add_missing_normals(mesh, {true, false, true, true, true, true});
  EXPECT_EQ(mesh.normals[2].x, 1);
  EXPECT_NE(mesh.normals[1].x, 1);
  EXPECT_EQ(mesh.positions.size(), 7u) << "only the missing one lies on the crease";
}

TEST(Normals, AreUnitVectorsOnRandomAndDegenerateSoups) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> anywhere(-1, 1);
  for (const float scale : {1e-18f, 1.0f, 1e18f}) {
    Mesh mesh;
    for (int i = 0; i < 60; ++i) {
      mesh.positions.push_back(
          {scale * anywhere(random), scale * anywhere(random), scale * anywhere(random)});
    }
    mesh.uvs.resize(60, {0.5f, 0.25f});
    mesh.colors.resize(60, {0.5f, 0.25f, 1});
    // Few vertices and many triangles, including needles, duplicates and degenerate triangles.
    for (int i = 0; i < 3000; ++i) {
      mesh.triangles.push_back({static_cast<std::uint32_t>(random() % 60),
                                static_cast<std::uint32_t>(random() % 60),
                                static_cast<std::uint32_t>(random() % 60)});
    }
    add_missing_normals(mesh);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
    ASSERT_EQ(mesh.colors.size(), mesh.positions.size());
    for (const Vec3& n : mesh.normals) ASSERT_NEAR(inner(n, n), 1, 1e-5);
    for (const auto& t : mesh.triangles) {
      for (const std::uint32_t v : t) ASSERT_LT(v, mesh.positions.size());
    }
  }
}

TEST(Normals, StayLinearWhereAllTrianglesMeet) {
  Mesh mesh;
  mesh.positions.push_back({0, 0, 1});
  constexpr std::uint32_t kCount = 200000;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const double angle = 2 * 3.14159265358979 * i / kCount;
    mesh.positions.push_back(
        {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
    mesh.triangles.push_back({0, i + 1, (i + 1) % kCount + 1});
  }
  add_missing_normals(mesh);
  EXPECT_EQ(mesh.triangles.size(), kCount);
}

}  // namespace
}  // namespace raysheaf::io
