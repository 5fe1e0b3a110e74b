// Incremental updates of a flattened scene give the bits of flattening it from scratch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "exec/executor.h"
#include "paper/base/flat_arrays.h"
#include "raysheaf/error.h"
#include "scene/flat_update.h"
#include "tests/scene/support.h"

namespace raysheaf {
namespace {

using test::below;
using test::Random;

SceneDescription random_scene(Random& random) {
  SceneDescription scene;
  for (int i = 0; i < 6; ++i) {
    scene.meshes.push_back(test::random_mesh(random, 1 + below(random, 40), below(random, 60), 1));
  }
  scene.meshes.push_back(test::random_mesh(random, 5, 3, 1));
  for (std::uint32_t i = 0; i < 12; ++i)
    scene.instances.push_back({"", below(random, 7), test::random_map(random)});
  scene.instances.push_back({"", 6, test::random_map(random)});
  return scene;
}

void expect_same(const FlatScene& a, const FlatScene& b) {
  ASSERT_EQ(a.triangle_count, b.triangle_count);
  for (std::uint32_t i = 0; i < a.triangle_count; ++i) {
    const std::array<Vec3, 3> x = a.corners(i), y = b.corners(i);
    ASSERT_EQ(std::memcmp(&x, &y, sizeof x), 0) << i;
  }
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.mesh_of_triangle, b.mesh_of_triangle);
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t i = 0; i < a.meshes.size(); ++i) {
    EXPECT_EQ(a.meshes[i].first_triangle, b.meshes[i].first_triangle);
    EXPECT_EQ(a.meshes[i].triangle_count, b.meshes[i].triangle_count);
    EXPECT_EQ(a.meshes[i].geom_id, b.meshes[i].geom_id);
    EXPECT_EQ(a.meshes[i].inst_id, b.meshes[i].inst_id);
    EXPECT_EQ(a.meshes[i].mirrored, b.meshes[i].mirrored);
    EXPECT_EQ(std::memcmp(&a.meshes[i].bound, &b.meshes[i].bound, sizeof(Sphere)), 0);
    EXPECT_EQ(std::memcmp(&a.meshes[i].box, &b.meshes[i].box, sizeof(Box)), 0);
  }
  EXPECT_EQ(std::memcmp(&a.bounds, &b.bounds, sizeof(Box)), 0);
}

void expect_same(const TriangleView& a, const TriangleView& b) {
  ASSERT_EQ(a.count, b.count);
  const std::size_t padded = (a.count + kTriangleBlock - 1) / kTriangleBlock * kTriangleBlock;
  const auto expect_same_floats = [&](const float* x, const float* y) {
    EXPECT_TRUE(padded == 0 || std::memcmp(x, y, padded * sizeof(float)) == 0);
  };
  for (int k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis) expect_same_floats(a.vertex[k][axis], b.vertex[k][axis]);
  for (int field = 0; field < 4; ++field) expect_same_floats(a.sphere[field], b.sphere[field]);
  EXPECT_TRUE(padded == 0 || std::memcmp(a.flags, b.flags, padded) == 0);
  EXPECT_EQ(std::memcmp(&a.bounds, &b.bounds, sizeof(Box)), 0);
}

/// Makes a random change and returns its description.
SceneChanges edit(Random& random, SceneDescription& scene) {
  SceneChanges changes;
  const std::uint32_t kind = below(random, 8);
  for (std::uint32_t i = 0; kind != 0 && i < scene.instances.size(); ++i) {
    if (below(random, 4) != 0) continue;
    scene.instances[i].to_world = test::random_map(random);
    changes.moved.push_back(i);
  }
  for (std::uint32_t m = 0; kind % 2 != 0 && m < scene.meshes.size(); ++m) {
    if (below(random, 3) != 0) continue;
    for (Vec3& p : scene.meshes[m].positions) p = test::random_point(random, 2);
    changes.deformed.push_back(m);
  }
  if (kind == 2) {
    // Different meshes of other sizes at the end, and their instances.
    changes.other_meshes_from = 1 + below(random, 6);
    changes.other_instances_from = 4 + below(random, 4);
    scene.meshes.resize(changes.other_meshes_from);
    const std::uint32_t meshes = changes.other_meshes_from + 1 + below(random, 4);
    while (scene.meshes.size() < meshes)
      scene.meshes.push_back(
          test::random_mesh(random, 1 + below(random, 30), 1 + below(random, 50), 1));
    // Earlier instances of removed meshes get other meshes.
    scene.instances.resize(changes.other_instances_from);
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
      if (scene.instances[i].mesh < changes.other_meshes_from) continue;
      scene.instances[i].mesh = below(random, meshes);
      changes.other_instances_from = std::min(changes.other_instances_from, i);
    }
    for (std::uint32_t i = below(random, 6); i < 8; ++i)
      scene.instances.push_back({"", below(random, meshes), test::random_map(random)});
  }
  if (kind == 3) {
    changes = {};
    changes.everything = true;
    scene = random_scene(random);
  }
  return changes;
}

bool is_same(const Sphere& a, const Sphere& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

void expect_bounds(const SceneDescription& scene, const SceneChanges& changes,
                   const std::vector<Sphere>& before, const std::vector<Sphere>& bounds) {
  ASSERT_EQ(bounds.size(), scene.meshes.size());
  for (std::uint32_t m = 0; m < bounds.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (changes.everything || m >= changes.other_meshes_from || m >= before.size())
      EXPECT_TRUE(is_same(bounds[m], mesh_bound(mesh)));
    else if (std::binary_search(changes.deformed.begin(), changes.deformed.end(), m))
      EXPECT_TRUE(is_same(bounds[m], shape_bound(mesh)));
    else
      EXPECT_TRUE(is_same(bounds[m], before[m]));
  }
}

/// Every vertex that a triangle uses lies within, and the sphere is not much larger than the least.
TEST(FlatUpdate, SpheresOfShapesHoldTheirVertices) {
  Random random(5);
  EXPECT_LT(shape_bound(Mesh{}).radius, 0);
  for (int round = 0; round < 300; ++round) {
    const float scales[4] = {1, 1e-30f, 1e6f, 9e17f};
    Mesh mesh = test::random_mesh(random, 1 + below(random, 40), 1 + below(random, 60), 1);
    for (Vec3& p : mesh.positions) p = p * scales[round % 4];
    const Sphere sphere = shape_bound(mesh);
    double farthest = 0;
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t v : triangle) {
        const Vec3 p = mesh.positions[v];
        const long double x = static_cast<long double>(p.x) - sphere.center.x;
        const long double y = static_cast<long double>(p.y) - sphere.center.y;
        const long double z = static_cast<long double>(p.z) - sphere.center.z;
        const long double distance = std::sqrt(x * x + y * y + z * z);
        EXPECT_LE(distance, static_cast<long double>(sphere.radius));
        farthest = std::max(farthest, static_cast<double>(distance));
      }
    }
    EXPECT_LE(sphere.radius, farthest * 1.000001 + 1e-44);
    EXPECT_LE(sphere.radius, 1.74f * mesh_bound(mesh).radius + 1e-44f);
    std::reverse(mesh.triangles.begin(), mesh.triangles.end());
    EXPECT_TRUE(is_same(shape_bound(mesh), sphere));
  }
}

TEST(FlatUpdate, EqualsFlatteningFromScratch) {
  Random random(7);
  for (const std::uint32_t threads : {1u, 4u}) {
    const Executor executor(threads);
    SceneDescription scene = random_scene(random);
    std::vector<Sphere> bounds = mesh_bounds(executor, scene);
    FlatScene flat = flatten(executor, scene, bounds);
    FlatArrays arrays(executor, flat);
    SceneChanges pending;
    for (int round = 0; round < 300; ++round) {
      pending.add(edit(random, scene));
      if (below(random, 3) == 0) continue;  // changes accumulate until the next round
      validate_changes(scene, pending);
      const std::vector<Sphere> before = bounds;
      update_bounds(executor, scene, pending, &bounds);
      expect_bounds(scene, pending, before, bounds);
      const FlatUpdate update = update_flat(executor, scene, pending, bounds, &flat);
      EXPECT_LE(update.placed_triangles, scene.triangle_count());
      if (pending.empty()) {
        EXPECT_TRUE(update.same_triangles && update.placed_meshes.empty());
      }
      if (update.same_triangles)
        arrays.move(executor, flat, View<const std::uint32_t>(update.placed_meshes));
      else
        arrays = FlatArrays(executor, flat);
      const FlatScene anew = flatten(executor, scene, bounds);
      expect_same(flat, anew);
      expect_same(arrays.view(), FlatArrays(executor, anew).view());
      if (HasFailure()) return;
      pending = {};
    }
  }
}

TEST(FlatUpdate, UpdatesMovedInstancesAndDeformedMeshes) {
  Random random(3);
  const Executor executor(2);
  SceneDescription scene = random_scene(random);
  std::vector<Sphere> bounds = mesh_bounds(executor, scene);
  FlatScene flat = flatten(executor, scene, bounds);
  const std::uint32_t last = static_cast<std::uint32_t>(scene.instances.size()) - 1;

  scene.instances[last].to_world = test::random_map(random);
  SceneChanges moved;
  moved.moved = {last};
  EXPECT_EQ(update_bounds(executor, scene, moved, &bounds), 0u);
  const FlatUpdate of_moved = update_flat(executor, scene, moved, bounds, &flat);
  EXPECT_EQ(of_moved.placed_triangles, scene.meshes[6].triangles.size());
  EXPECT_TRUE(of_moved.same_triangles);

  scene.meshes[6].positions[0].x += 1;
  SceneChanges deformed;
  deformed.deformed = {6};
  EXPECT_EQ(update_bounds(executor, scene, deformed, &bounds), 1u);
  std::size_t shown = 0;
  for (const Instance& instance : scene.instances) shown += instance.mesh == 6 ? 1 : 0;
  const FlatUpdate of_deformed = update_flat(executor, scene, deformed, bounds, &flat);
  EXPECT_EQ(of_deformed.placed_triangles, shown * scene.meshes[6].triangles.size());
  EXPECT_TRUE(of_deformed.same_triangles);
}

TEST(FlatUpdate, RefusesInvalidIndices) {
  Random random(4);
  const SceneDescription scene = random_scene(random);
  SceneChanges changes;
  changes.moved = {1, 99};
  EXPECT_THROW(validate_changes(scene, changes), Error);
  changes.moved = {2, 2};
  EXPECT_THROW(validate_changes(scene, changes), Error);
  changes.moved = {1, 2};
  EXPECT_NO_THROW(validate_changes(scene, changes));
}

}  // namespace
}  // namespace raysheaf
