// The generated halls are closed, as large as requested, and the same with any number of threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/vec.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

TEST(Hall, HasNearlyAsManyTrianglesAsAskedFor) {
  for (const std::uint64_t count : {4000u, 10'000u, 123'456u, 400'000u}) {
    const std::uint64_t made = hall_scene(count).triangle_count();
    EXPECT_LE(made, count);
    EXPECT_GE(static_cast<double>(made), 0.95 * static_cast<double>(count));
  }
}

TEST(Hall, IsAValidSceneWithACameraAndALamp) {
  const SceneDescription scene = hall_scene(20'000);
  EXPECT_NO_THROW(validate(scene));
  EXPECT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.lights.size(), 1u);
}

TEST(Hall, IsTheSameWithAnyThreads) {
  const SceneDescription one = hall_scene(30'000, 1), two = hall_scene(30'000, 2);
  ASSERT_EQ(one.meshes.size(), two.meshes.size());
  for (std::size_t i = 0; i < one.meshes.size(); ++i) {
    EXPECT_EQ(one.meshes[i].triangles, two.meshes[i].triangles);
    EXPECT_TRUE(std::equal(one.meshes[i].positions.begin(), one.meshes[i].positions.end(),
                           two.meshes[i].positions.begin()));
    EXPECT_TRUE(std::equal(one.meshes[i].normals.begin(), one.meshes[i].normals.end(),
                           two.meshes[i].normals.begin()));
  }
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// How many directed edges of a mesh have no partner.
std::size_t open_edges(const Mesh& mesh) {
  std::map<Edge, int> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  return static_cast<std::size_t>(std::count_if(edges.begin(), edges.end(), [&](const auto& edge) {
    return !edges.contains({edge.first.second, edge.first.first});
  }));
}

TEST(Hall, BallsAreClosedAndColumnsOpenAtTheirEnds) {
  int balls = 0, columns = 0;
  for (const Mesh& mesh : hall_scene(20'000).meshes) {
    balls += mesh.name == "ball" ? 1 : 0;
    columns += mesh.name == "column" ? 1 : 0;
    EXPECT_EQ(open_edges(mesh) == 0, mesh.name == "ball") << mesh.name;
    for (const auto& t : mesh.triangles)
      EXPECT_TRUE(t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) << mesh.name;
  }
  EXPECT_EQ(balls, 24);
  EXPECT_EQ(columns, 16);
}

/// Normals agree with the triangles, and walls face into the hall.
TEST(Hall, FacesLookInside) {
  const SceneDescription scene = hall_scene(20'000);
  const Vec3 middle{0, 5, 0};
  for (const Mesh& mesh : scene.meshes) {
    std::size_t against = 0, outward = 0;
    for (const auto& t : mesh.triangles) {
      const Vec3 p = mesh.positions[t[0]];
      const Vec3 n = cross(mesh.positions[t[1]] - p, mesh.positions[t[2]] - p);
      if (dot(n, mesh.normals[t[0]]) < 0) ++against;
      if (dot(n, p - middle) > 0) ++outward;
    }
    EXPECT_LE(against, mesh.triangles.size() / 50) << mesh.name;
    const bool round = mesh.name == "ball" || mesh.name == "column";
    EXPECT_LE(round ? 0 : outward, mesh.triangles.size() / 50) << mesh.name;
  }
}

TEST(Hall, WallsMeetInStraightEdges) {
  for (const Mesh& mesh : hall_scene(20'000).meshes) {
    if (mesh.name == "ball" || mesh.name == "column") continue;
    std::size_t in_corners = 0;
    for (const Vec3 p : mesh.positions) {
      const bool x = std::fabs(std::fabs(p.x) - 20) < 1e-4f,
                 z = std::fabs(std::fabs(p.z) - 10) < 1e-4f;
      const bool y = p.y == 0 || std::fabs(p.y - 10) < 1e-4f;
      in_corners += x && y && z ? 1 : 0;
    }
    EXPECT_EQ(in_corners, 4u) << mesh.name;
  }
}

TEST(Hall, RefusesOtherSizes) {
  EXPECT_THROW((void)hall_scene(3999), Error);
  EXPECT_THROW((void)hall_scene(200'000'001), Error);
}

}  // namespace
}  // namespace raysheaf
