#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/mirrors_body.h"
#include "exec/executor.h"
#include "paper/base/flat_arrays.h"
#include "raysheaf/error.h"
#include "scene/flatten_body.h"
#include "scene/material_of.h"
#include "scene/mesh_bound_body.h"
#include "tests/scene/support.h"

namespace raysheaf {
namespace {

using test::one_triangle;
using test::Random;

double distance(Vec3 a, Vec3 b) {
  return std::hypot(static_cast<double>(a.x) - b.x, static_cast<double>(a.y) - b.y,
                    static_cast<double>(a.z) - b.z);
}
bool inside(Vec3 p, const Sphere& s) {
  return distance(p, s.center) <= s.radius;
}

FlatScene flattened(const SceneDescription& scene, std::uint32_t threads = 2) {
  const Executor executor(threads);
  return flatten(executor, scene, mesh_bounds(executor, scene));
}

FlatArrays arrays_of(const SceneDescription& scene, std::uint32_t threads = 2) {
  return {Executor(threads), flattened(scene, threads)};
}

Sphere sphere_of(const TriangleView& triangles, std::size_t i) {
  const auto& field = triangles.sphere;
  return {{field[0][i], field[1][i], field[2][i]}, field[3][i]};
}

SceneDescription random_instances(Random& random) {
  SceneDescription scene;
  scene.materials.resize(3);
  scene.materials[1].double_sided = true;
  for (int i = 0; i < 6; ++i) {
    scene.meshes.push_back(
        test::random_mesh(random, 1 + test::below(random, 40), test::below(random, 60), 1));
    Mesh& mesh = scene.meshes.back();
    if (i % 3 == 1) mesh.materials = {1};
    if (i % 3 == 2) {
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        mesh.materials.push_back(test::below(random, 3));
    }
  }
  for (int i = 0; i < 12; ++i) {
    scene.instances.push_back({"", test::below(random, 6), test::random_map(random)});
  }
  return scene;
}

TEST(MeshBound, HoldsEveryVertexUnderAnyAffineMap) {
  Random random(1);
  for (int round = 0; round < 3000; ++round) {
    SceneDescription scene;
    const float scale = std::pow(10.0f, test::uniform(random, -6, 6));
    scene.meshes.push_back(test::random_mesh(random, 1 + test::below(random, 20), 30, scale));
    for (Vec3& p : scene.meshes[0].positions) {
      if (round % 3 == 0) p += Vec3{1e5f, -1e5f, 1e5f} * scale;
    }
    const Sphere bound = mesh_bounds(Executor(1), scene)[0];
    const Affine map = test::random_map(random);
    const Sphere moved = transformed(bound, map);
    for (const auto& triangle : scene.meshes[0].triangles) {
      for (const std::uint32_t v : triangle) {
        ASSERT_TRUE(inside(transform_point(map, scene.meshes[0].positions[v]), moved));
      }
    }
  }
}

TEST(MeshBound, IsNotLoose) {
  // Points all over a sphere: their images' largest distance from the centre is the ellipsoid's
  // longest half axis, and no valid radius is smaller.
  Random random(2);
  for (int round = 0; round < 200; ++round) {
    const Affine turn =
        rotation(normalized(test::random_point(random, 1)), test::uniform(random, 0, 6));
    const Vec3 axes{1, test::uniform(random, 0, 1), -test::uniform(random, 0, 1)};
    const Affine map = compose(turn, compose(scaling(axes), turn));
    const Sphere moved = transformed({{1, 2, 3}, 2}, map);
    EXPECT_NEAR(moved.radius, 2, 1e-4);
    EXPECT_LT(distance(moved.center, transform_point(map, {1, 2, 3})), 1e-5);
  }
}

TEST(MeshBound, StretchIsTheLargestSingularValue) {
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    const Affine map = test::random_map(random);
    // Power iteration on the Gram matrix gives a lower bound.
    double v[3] = {0.3, 0.5, 0.7}, stretch = 0;
    for (int i = 0; i < 2000; ++i) {
      double w[3] = {}, back[3] = {};
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) w[r] += map.m[r][c] * v[c];
      }
      stretch = std::hypot(w[0], w[1], w[2]);
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) back[c] += map.m[r][c] * w[r];
      }
      const double size = std::hypot(back[0], back[1], back[2]);
      if (size == 0) break;
      for (int c = 0; c < 3; ++c) v[c] = back[c] / size;
    }
    EXPECT_GE(largest_stretch(map), stretch * (1 - 1e-14));
    EXPECT_LE(largest_stretch(map), stretch * (1 + 1e-2) + 1e-30);
  }
  EXPECT_NEAR(largest_stretch(scaling({3, -7, 2})), 7, 1e-10);
  EXPECT_EQ(largest_stretch(scaling({0, 0, 0})), 0);
}

TEST(MeshBound, EmptyStaysEmpty) {
  SceneDescription scene = one_triangle();
  scene.meshes[0].triangles.clear();
  const Sphere bound = mesh_bounds(Executor(1), scene)[0];
  EXPECT_LT(bound.radius, 0);
  EXPECT_LT(transformed(bound, scaling({5, 5, 5})).radius, 0);
}

TEST(Flatten, IdsRoundTrip) {
  Random random(4);
  for (int round = 0; round < 50; ++round) {
    const SceneDescription scene = random_instances(random);
    const FlatScene flat = flattened(scene);
    ASSERT_EQ(flat.triangle_count, scene.triangle_count());
    std::tuple<std::uint32_t, std::uint32_t> before{0, 0};
    std::uint32_t next = 0;
    for (const FlatMesh& mesh : flat.meshes) {
      ASSERT_EQ(mesh.first_triangle, next);
      ASSERT_GT(mesh.triangle_count, 0u);
      ASSERT_EQ(scene.instances[mesh.inst_id].mesh, mesh.geom_id);
      ASSERT_EQ(scene.meshes[mesh.geom_id].triangles.size(), mesh.triangle_count);
      ASSERT_TRUE(next == 0 || before < std::tuple(mesh.geom_id, mesh.inst_id));
      before = {mesh.geom_id, mesh.inst_id};
      next += mesh.triangle_count;
      ASSERT_TRUE(is_finite(mesh.bound.center));
    }
    ASSERT_EQ(next, flat.triangle_count);
  }
}

TEST(Flatten, TrianglesStandWhereTheirInstancePutsThem) {
  Random random(5);
  for (int round = 0; round < 50; ++round) {
    const SceneDescription scene = random_instances(random);
    const FlatScene flat = flattened(scene);
    Box box;
    for (std::uint32_t i = 0; i < flat.triangle_count; ++i) {
      const FlatMesh& placed = flat.meshes[flat.mesh_of_triangle[i]];
      const std::uint32_t prim_id = i - placed.first_triangle;
      ASSERT_LT(prim_id, placed.triangle_count);
      const Mesh& mesh = scene.meshes[placed.geom_id];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 world = transform_point(scene.instances[placed.inst_id].to_world,
                                           mesh.positions[mesh.triangles[prim_id][k]]);
        ASSERT_EQ(flat.corners(i)[k], world);
        ASSERT_TRUE(inside(world, placed.bound));
        box.min = min(box.min, world), box.max = max(box.max, world);
      }
      const bool single_sided =
          !material_or_default(scene, material_of(mesh, prim_id)).double_sided;
      ASSERT_EQ((flat.flags[i] & kSingleSided) != 0, single_sided);
      ASSERT_EQ((flat.flags[i] & kMirrored) != 0, placed.mirrored);
    }
    ASSERT_EQ(flat.bounds.min, box.min);
    ASSERT_EQ(flat.bounds.max, box.max);
  }
}

TEST(FlatArrays, HoldTheCornersSpheresAndFlags) {
  Random random(5);
  for (int round = 0; round < 50; ++round) {
    const SceneDescription scene = random_instances(random);
    const FlatScene flat = flattened(scene);
    const FlatArrays arrays(Executor(2), flat);
    const TriangleView triangles = arrays.view();
    ASSERT_EQ(triangles.count, flat.triangle_count);
    EXPECT_EQ(triangles.bounds.min, flat.bounds.min);
    EXPECT_EQ(triangles.bounds.max, flat.bounds.max);
    for (std::uint32_t i = 0; i < flat.triangle_count; ++i) {
      const auto [a, b, c] = flat.corners(i);
      const bool flat_one = has_no_area(a, b, c);
      EXPECT_EQ(triangles.corner(i, 0), a);
      EXPECT_EQ(triangles.corner(i, 1), flat_one ? a : b);
      EXPECT_EQ(triangles.corner(i, 2), flat_one ? a : c);
      for (int k = 0; k < 3; ++k)
        ASSERT_TRUE(inside(triangles.corner(i, k), sphere_of(triangles, i)));
      ASSERT_EQ(triangles.flags[i], flat.flags[i]);
    }
  }
}

TEST(FlatArrays, NothingHitsThePadding) {
  Random random(6);
  for (std::uint32_t count = 1; count < 40; ++count) {
    SceneDescription scene;
    scene.meshes.push_back(test::random_mesh(random, 10, count, 1e6f));
    scene.instances.resize(1);
    const FlatArrays arrays = arrays_of(scene);
    const TriangleView triangles = arrays.view();
    ASSERT_EQ(triangles.count, count);
    for (std::uint32_t i = count; i % kTriangleBlock != 0; ++i) {
      const Sphere s = sphere_of(triangles, i);
      ASSERT_TRUE(is_finite(s.center));
      ASSERT_LT(s.radius + 1e29f, 0);
      for (int k = 1; k < 3; ++k) ASSERT_EQ(triangles.corner(i, k), triangles.corner(i, 0));
    }
  }
}

TEST(FlatArrays, AreAlignedToCacheLines) {
  const FlatArrays arrays = arrays_of(one_triangle());
  const TriangleView view = arrays.view();
  EXPECT_EQ(view.flags[0], kSingleSided);
  for (const float* field : {view.vertex[0][0], view.vertex[2][1], view.sphere[3]})
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(field) % kCacheLineBytes, 0u);
}

TEST(FlatArrays, ZeroAreaTrianglesCollapse) {
  SceneDescription scene = one_triangle();
  Mesh& mesh = scene.meshes[0];
  mesh.positions = {{1, 2, 3}, {2, 4, 6},      {3, 6, 9},      {1, 2, 3},
                    {5, 5, 5}, {1e-30f, 0, 0}, {0, 1e-30f, 0}, {0, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}, {4, 4, 4}, {4, 0, 4}, {5, 6, 7}, {0, 1, 4}};
  const FlatArrays arrays = arrays_of(scene);
  const TriangleView triangles = arrays.view();
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(triangles.corner(i, 1), triangles.corner(i, 0));
    EXPECT_EQ(triangles.corner(i, 2), triangles.corner(i, 0));
    EXPECT_EQ(triangles.sphere[3][i], 0);
  }
  // A tiny triangle is not degenerate.
  EXPECT_EQ(triangles.corner(4, 1), (Vec3{0, 1e-30f, 0}));
  EXPECT_EQ(triangles.corner(5, 2), (Vec3{5, 5, 5}));
}

TEST(FlatArrays, SpheresHoldSliversAndNeedlesAtAnyScale) {
  Random random(7);
  SceneDescription scene;
  scene.meshes.resize(1);
  scene.instances.resize(1);
  Mesh& mesh = scene.meshes[0];
  for (std::uint32_t i = 0; i < 30000; ++i) {
    const float scale = std::pow(10.0f, test::uniform(random, -40, 17));
    const Vec3 a = test::random_point(random, scale) +
                   test::random_point(random, scale) * (i % 5 == 0 ? 1e5f : 0);
    const Vec3 along = test::random_point(random, scale),
               thin = test::random_point(random, scale * 1e-6f);
    const Vec3 c = i % 3 == 0   ? a + along * 0.5f + thin
                   : i % 3 == 1 ? a + thin
                                : test::random_point(random, scale);
    for (const Vec3 p : {a, a + along, c}) {
      const float most = kLargestCoordinate;
      mesh.positions.push_back(min(max(p, {-most, -most, -most}), {most, most, most}));
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const FlatArrays arrays = arrays_of(scene);
  const TriangleView triangles = arrays.view();
  for (std::uint32_t i = 0; i < triangles.count; ++i) {
    const Sphere s = sphere_of(triangles, i);
    ASSERT_TRUE(is_finite(s.center)) << i;
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      ASSERT_TRUE(inside(triangles.corner(i, k), s)) << i;
      longest =
          std::max(longest, distance(triangles.corner(i, k), triangles.corner(i, (k + 1) % 3)));
    }
    // A useful centre is no farther from a corner than the longest edge.
    ASSERT_LE(s.radius, longest * 1.01 + 1e-44) << i;
  }
}

// Products of shears have the determinant 1, and their entries grow until the terms of the
// determinant do not fit into binary64.
TEST(Flatten, TheSignOfADeterminantIsExact) {
  Random random(3);
  for (int round = 0; round < 1000; ++round) {
    Affine map;
    for (int step = 0; step < 200; ++step) {
      const auto to = std::size_t{random() % 3};
      const auto from = (to + 1 + std::size_t{random() % 2}) % 3;
      const float factor = random() % 2 != 0 ? 1.0f : -2.0f;
      Affine next = map;
      float largest = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        next.m[to][c] += factor * map.m[from][c];
        largest = std::max(largest, std::fabs(next.m[to][c]));
      }
      if (largest < 0x1p24f) map = next;
    }
    ASSERT_FALSE(mirrors(map)) << "round " << round;
    for (float& x : map.m[random() % 3]) x = -x;
    ASSERT_TRUE(mirrors(map)) << "round " << round;
    map.m[2] = map.m[1];  // singular
    ASSERT_FALSE(mirrors(map)) << "round " << round;
  }
}

TEST(Flatten, MirroredInstancesAreMarkedAtAnyScale) {
  for (const float scale : {1e-20f, 1.0f, 1e15f}) {
    SceneDescription scene = one_triangle();
    scene.instances.resize(2);
    scene.instances[0].to_world = scaling({scale, scale, scale});
    scene.instances[1].to_world = scaling({scale, -scale, scale});
    const FlatScene flat = flattened(scene);
    EXPECT_FALSE(flat.meshes[0].mirrored);
    EXPECT_TRUE(flat.meshes[1].mirrored);
    EXPECT_EQ(flat.flags[1] & kMirrored, kMirrored);
  }
}

TEST(Flatten, NamesTheInstanceThatOverflows) {
  for (const float scale : {1e19f, 3e38f}) {
    SceneDescription scene = one_triangle();
    scene.meshes[0].positions[1].x = 10;
    scene.instances.resize(3);
    scene.instances[1].name = "far";
    scene.instances[1].to_world = scaling({scale, 1, 1});
    scene.instances[2].to_world = scaling({scale, 1, 1});
    try {
      static_cast<void>(flattened(scene));
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidData);
      EXPECT_EQ(error.place(), "instances[1].to_world");
      EXPECT_NE(error.sentence().find("far"), std::string::npos);
    }
  }
}

TEST(Flatten, DoesNotDependOnTheThreads) {
  Random random(8);
  SceneDescription scene;
  scene.meshes.push_back(test::random_mesh(random, 5000, 20000, 3));
  scene.instances.resize(2);
  scene.instances[1].to_world = test::random_map(random);
  const FlatScene one = flattened(scene, 1), many = flattened(scene, 4);
  for (std::uint32_t i = 0; i < one.triangle_count; ++i)
    ASSERT_EQ(one.corners(i), many.corners(i)) << i;
  EXPECT_EQ(one.flags, many.flags);
  EXPECT_EQ(one.mesh_of_triangle, many.mesh_of_triangle);
  EXPECT_EQ(one.bounds.min, many.bounds.min);
  EXPECT_EQ(one.bounds.max, many.bounds.max);
}

}  // namespace
}  // namespace raysheaf
