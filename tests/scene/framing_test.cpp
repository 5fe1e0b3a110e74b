#include <gtest/gtest.h>

#include <cmath>

#include "tests/scene/support.h"

namespace raysheaf {
namespace {

using test::one_triangle;
using test::Random;

/// Every vertex is in a square view, between the planes.
void expect_seen(const SceneDescription& scene, const Camera& camera) {
  const double slope = std::tan(camera.y_fov / 2.0);
  const Affine& m = camera.to_world;
  const Vec3 eye = column(m, 3);
  for (const Instance& instance : scene.instances) {
    for (const Vec3 position : scene.meshes[instance.mesh].positions) {
      const Vec3 p = transform_point(instance.to_world, position) - eye;
      const double depth = -dot(p, column(m, 2));
      ASSERT_GT(depth, camera.z_near);
      ASSERT_LT(depth, camera.z_far);
      ASSERT_LT(std::fabs(dot(p, column(m, 0))), slope * depth);
      ASSERT_LT(std::fabs(dot(p, column(m, 1))), slope * depth);
    }
  }
}

TEST(Framing, SeesAllOfRandomScenes) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    SceneDescription scene;
    const float scale = std::pow(10.0f, test::uniform(random, -12, 12));
    scene.meshes.push_back(test::random_mesh(random, 20, 100, scale));
    scene.instances.resize(2);
    scene.instances[1].to_world = translation(test::random_point(random, 10 * scale));
    const Camera camera = framing_camera(scene);
    expect_seen(scene, camera);
    scene.cameras.push_back(camera);
    scene.lights.push_back(showing_light(scene, camera));
    EXPECT_NO_THROW(validate(scene));
  }
}

TEST(Framing, LooksFromTheFrontRightAndAbove) {
  const Camera camera = framing_camera(one_triangle());
  const Vec3 eye = column(camera.to_world, 3);
  EXPECT_GT(eye.x, 1);
  EXPECT_GT(eye.y, 1);
  EXPECT_GT(eye.z, 1);
  EXPECT_GT(column(camera.to_world, 1).y, 0.5f);
}

TEST(Framing, FlatAndPointScenesWork) {
  for (const Vec3 at : {Vec3{0, 0, 0}, Vec3{1e6f, -3, 1e-6f}}) {
    for (const Vec3 size : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 0, 1}}) {
      SceneDescription scene = one_triangle();
      scene.meshes[0].positions = {at, at + size, at - size};
      add_missing_camera_and_light(scene);
      expect_seen(scene, scene.cameras.at(0));
      EXPECT_NO_THROW(validate(scene));
    }
  }
}

TEST(Framing, IsTheSameWhereverTheMeshLies) {
  Random random(3);
  for (const float away : {1e3f, 1e5f, 1e6f}) {
    SceneDescription scene;
    scene.meshes.push_back(test::random_mesh(random, 20, 100, 5));
    scene.instances.resize(1);
    const Camera at_origin = framing_camera(scene);
    scene.instances[0].to_world = translation({away, -away, away});
    const Camera there = framing_camera(scene);
    const float spacing = away * 0x1p-22f;
    EXPECT_NEAR(there.z_near, at_origin.z_near, 8 * spacing);
    EXPECT_NEAR(there.z_far, at_origin.z_far, 16 * spacing);
    const Vec3 moved = column(there.to_world, 3) - column(at_origin.to_world, 3);
    EXPECT_NEAR(moved.x, away, 8 * spacing);
    EXPECT_NEAR(moved.y, -away, 8 * spacing);
    expect_seen(scene, there);
  }
}

TEST(Framing, LeavesOutTrianglesWithoutArea) {
  SceneDescription scene = one_triangle();
  const Box before = world_bounds(scene);
  Mesh& mesh = scene.meshes[0];
  mesh.positions.insert(mesh.positions.end(), {{1e6f, 0, 0}, {2e6f, 0, 0}, {4e6f, 0, 0}});
  mesh.triangles.insert(mesh.triangles.end(), {{3, 3, 3}, {3, 4, 4}, {3, 4, 5}});
  EXPECT_EQ(world_bounds(scene).max, before.max);
  EXPECT_EQ(world_bounds(scene).min, before.min);
  mesh.triangles.erase(mesh.triangles.begin());
  EXPECT_EQ(world_bounds(scene).max.x, 4e6f) << "nothing has an area";
}

TEST(Framing, AnEmptySceneStillHasACamera) {
  SceneDescription scene;
  EXPECT_TRUE(is_finite(column(framing_camera(scene).to_world, 3)));
}

TEST(Framing, TheLightIsAboveAndLeftOfTheCamera) {
  const SceneDescription scene = one_triangle();
  const Camera camera = framing_camera(scene);
  const Light light = showing_light(scene, camera);
  const Vec3 from_eye = light.position - column(camera.to_world, 3);
  EXPECT_GT(dot(from_eye, column(camera.to_world, 1)), 0);
  EXPECT_LT(dot(from_eye, column(camera.to_world, 0)), 0);
}

TEST(Framing, AddsOnlyWhatIsMissing) {
  SceneDescription scene = one_triangle();
  scene.cameras.resize(2);
  scene.lights.resize(1);
  add_missing_camera_and_light(scene);
  EXPECT_EQ(scene.cameras.size(), 2u);
  EXPECT_EQ(scene.lights.size(), 1u);

  SceneDescription glowing = one_triangle();
  glowing.materials.resize(1);
  glowing.materials[0].emission = {0, 1, 0};
  add_missing_camera_and_light(glowing);
  EXPECT_EQ(glowing.cameras.size(), 1u);
  EXPECT_EQ(glowing.lights.size(), 1u);  // what glows does not light the rest

  SceneDescription unlit = one_triangle();
  unlit.materials.resize(1);
  unlit.materials[0].unlit = true;
  add_missing_camera_and_light(unlit);
  EXPECT_TRUE(unlit.lights.empty());
}

}  // namespace
}  // namespace raysheaf
