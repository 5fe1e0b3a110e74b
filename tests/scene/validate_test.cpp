#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "raysheaf/error.h"
#include "tests/scene/support.h"

namespace raysheaf {
namespace {

using test::one_triangle;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// A valid scene with everything that a scene can have.
SceneDescription full_scene() {
  SceneDescription scene = one_triangle();
  Mesh& mesh = scene.meshes[0];
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
  mesh.colors = {{0, 0, 0}, {1, 0, 0}, {0, 2, 1}};
  mesh.materials = {0};
  scene.materials.resize(2);
  scene.materials[0].base_color_texture.texture = 0;
  scene.textures.push_back({0});
  scene.images.push_back({"wood", 2, 1, std::vector<std::uint8_t>(8)});
  scene.lights.resize(3);
  scene.lights[1].type = Light::Type::kSpot;
  scene.lights[2].type = Light::Type::kDirectional;
  scene.cameras.resize(2);
  scene.cameras[1].orthographic = true;
  return scene;
}

struct Defect {
  const char* place;
  std::function<void(SceneDescription&)> make;
  const char* said = "";
};

const Defect kDefects[] = {
    {"meshes[0].triangles[0]", [](auto& s) { s.meshes[0].triangles[0][2] = 90; },
     "triangles[0][2] of \"Chair\" is 90, but the mesh has 3 vertices"},
    {"meshes[0].triangles[0]",
     [](auto& s) {
       s.meshes[0].positions.clear(), s.meshes[0].normals.clear(), s.meshes[0].uvs.clear();
       s.meshes[0].colors.clear();
     }},
    {"meshes[0].positions[1]", [](auto& s) { s.meshes[0].positions[1].y = kNan; }, "is not finite"},
    {"meshes[0].positions[2]", [](auto& s) { s.meshes[0].positions[2].z = -kInf; }},
    {"meshes[0].positions[2]", [](auto& s) { s.meshes[0].positions[2].z = -1.1e18f; },
     "is farther out than 1e18"},
    {"meshes[0].normals", [](auto& s) { s.meshes[0].normals.pop_back(); },
     "has 2 normals, but 3 vertices"},
    {"meshes[0].normals[0]", [](auto& s) { s.meshes[0].normals[0].x = kNan; }},
    {"meshes[0].uvs", [](auto& s) { s.meshes[0].uvs.push_back({}); }},
    {"meshes[0].uvs[2]", [](auto& s) { s.meshes[0].uvs[2].y = kInf; }},
    {"meshes[0].colors", [](auto& s) { s.meshes[0].colors.pop_back(); }, "has 2 colors"},
    {"meshes[0].colors[1]", [](auto& s) { s.meshes[0].colors[1].y = kNan; }},
    {"meshes[0].colors[2]", [](auto& s) { s.meshes[0].colors[2].z = -1; }, "is negative"},
    {"meshes[0].materials",
     [](auto& s) {
       s.meshes[0].materials = {0, 0};
     }},
    {"meshes[0].materials[0]", [](auto& s) { s.meshes[0].materials = {2}; },
     "the scene has 2 materials"},
    {"instances[0].mesh", [](auto& s) { s.instances[0].mesh = 1; }, "the scene has 1 meshes"},
    {"instances[0].to_world", [](auto& s) { s.instances[0].to_world.m[2][3] = kNan; }},
    {"materials[1].base_color", [](auto& s) { s.materials[1].base_color.y = kNan; }},
    {"materials[1].base_color", [](auto& s) { s.materials[1].base_color.y = -1; }},
    {"materials[1].metallic", [](auto& s) { s.materials[1].metallic = 1.5f; }},
    {"materials[1].roughness", [](auto& s) { s.materials[1].roughness = kNan; }},
    {"materials[1].emission", [](auto& s) { s.materials[1].emission.z = kInf; }},
    {"materials[1].specular", [](auto& s) { s.materials[1].specular = -0.1f; }},
    {"materials[1].specular_color", [](auto& s) { s.materials[1].specular_color.x = -1; }},
    {"materials[1].transmission", [](auto& s) { s.materials[1].transmission = 2; }},
    {"materials[1].ior", [](auto& s) { s.materials[1].ior = 0.5f; }},
    {"materials[0].base_color_texture.texture",
     [](auto& s) { s.materials[0].base_color_texture.texture = 1; }},
    {"materials[0].base_color_texture",
     [](auto& s) { s.materials[0].base_color_texture.rotation = kNan; }},
    {"materials[1].emission_texture.texture",
     [](auto& s) { s.materials[1].emission_texture.texture = 7; }},
    {"materials[1].normal_texture.texture",
     [](auto& s) { s.materials[1].normal_texture.texture = 7; }},
    {"materials[0].alpha_cutoff", [](auto& s) { s.materials[0].alpha_cutoff = -1; }},
    {"materials[0].base_color", [](auto& s) { s.materials[0].base_color.w = kNan; }},
    {"materials[0].normal_scale", [](auto& s) { s.materials[0].normal_scale = kInf; }},
    {"textures[0].image", [](auto& s) { s.textures[0].image = 1; }, "the scene has 1 images"},
    {"images[0].width", [](auto& s) { s.images[0].width = 0; }},
    {"images[0].rgba", [](auto& s) { s.images[0].rgba.pop_back(); }},
    {"images[0].rgba", [](auto& s) { s.images[0].width = s.images[0].height = 0xffffffffu; }},
    {"lights[0].position", [](auto& s) { s.lights[0].position.x = kNan; }},
    {"lights[0].intensity", [](auto& s) { s.lights[0].intensity.x = -1; }},
    {"lights[0].range", [](auto& s) { s.lights[0].range = 0; }},
    {"lights[1].direction",
     [](auto& s) {
       s.lights[1].direction = {0, 0, 0};
     }},
    {"lights[1].outer_angle", [](auto& s) { s.lights[1].outer_angle = 2; }},
    {"lights[1].inner_angle", [](auto& s) { s.lights[1].inner_angle = 1; }},
    {"lights[2].direction",
     [](auto& s) {
       s.lights[2].direction = {0, 3, 0};
     }},
    {"cameras[0].to_world", [](auto& s) { s.cameras[0].to_world.m[0][0] = kNan; }},
    {"cameras[0].to_world",
     [](auto& s) {
       s.cameras[0].to_world.m[1] = {0, 0, 0, 0};
     }},
    {"cameras[0].y_fov", [](auto& s) { s.cameras[0].y_fov = 3.2f; }},
    {"cameras[0].y_fov", [](auto& s) { s.cameras[0].y_fov = 0; }},
    {"cameras[0].z_near", [](auto& s) { s.cameras[0].z_near = 0; }},
    {"cameras[0].z_far", [](auto& s) { s.cameras[0].z_far = s.cameras[0].z_near; }},
    {"cameras[1].y_mag", [](auto& s) { s.cameras[1].y_mag = -1; }},
    {"", [](auto& s) { s.instances.clear(); }, "the scene has no triangles"},
    {"", [](auto& s) { s.meshes[0].triangles.clear(); }, "the scene has no triangles"},
};

TEST(Validate, AcceptsAValidScene) {
  EXPECT_NO_THROW(validate(full_scene()));
  EXPECT_NO_THROW(validate(one_triangle()));
  SceneDescription default_material = one_triangle();
  default_material.meshes[0].materials = {kInvalidId};
  EXPECT_NO_THROW(validate(default_material));
}

TEST(Validate, NamesEachDefect) {
  for (const Defect& defect : kDefects) {
    SceneDescription scene = full_scene();
    defect.make(scene);
    try {
      validate(scene);
      ADD_FAILURE() << "accepted a wrong " << defect.place;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidData);
      EXPECT_EQ(error.place(), defect.place);
      EXPECT_NE(error.sentence().find(defect.said), std::string::npos) << error.sentence();
    }
  }
}

TEST(Validate, NamesTheFirstDefect) {
  SceneDescription scene = full_scene();
  scene.cameras[0].y_fov = -1;
  scene.meshes[0].triangles.push_back({0, 1, 3});
  scene.meshes[0].triangles.push_back({0, 1, 4});
  try {
    validate(scene);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.place(), "meshes[0].triangles[1]");
  }
}

TEST(Validate, ShowsOddNamesSafely) {
  SceneDescription scene = one_triangle();
  scene.meshes[0].name = "a\nb" + std::string(1000000, 'x');
  scene.meshes[0].positions[0].x = kNan;
  try {
    validate(scene);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_LT(error.sentence().size(), 200u);
    EXPECT_EQ(error.sentence().find('\n'), std::string::npos);
  }
}

TEST(Description, CountsTrianglesOnceAnInstance) {
  SceneDescription scene = one_triangle();
  scene.instances.resize(3);
  scene.meshes.push_back(scene.meshes[0]);
  EXPECT_EQ(scene.triangle_count(), 3u);
  EXPECT_EQ(SceneDescription{}.triangle_count(), 0u);
}

TEST(Description, BoundsAreThoseOfTheTriangles) {
  SceneDescription scene = one_triangle();
  scene.meshes[0].positions.push_back({100, 100, 100});  // not used by a triangle
  scene.instances[0].to_world = compose(translation({1, 2, 3}), scaling({2, 2, -2}));
  const Box box = world_bounds(scene);
  EXPECT_EQ(box.min, (Vec3{1, 2, 3}));
  EXPECT_EQ(box.max, (Vec3{3, 4, 3}));
  EXPECT_GT(world_bounds(SceneDescription{}).min.x, world_bounds(SceneDescription{}).max.x);
}

// Most instances are not looked at.
TEST(Description, BoundsOfManyInstancesAreThoseOfEachAlone) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> entries(-3, 3);
  SceneDescription scene = one_triangle();
  scene.meshes.push_back(scene.meshes[0]);
  scene.meshes[1].positions = {{-1, 0, 2}, {3, 1, 0}, {0, 5, -2}};
  scene.meshes.push_back(scene.meshes[0]);  // shown only once
  scene.instances.clear();
  Box expected;
  for (std::uint32_t i = 0; i < 500; ++i) {
    Instance instance;
    instance.mesh = i == 250 ? 2 : i % 2;
    for (auto& row : instance.to_world.m)
      for (float& entry : row) entry = entries(random);
    scene.instances.push_back(instance);
    SceneDescription alone = scene;
    alone.instances = {instance};
    const Box box = world_bounds(alone);
    expected.min = min(expected.min, box.min);
    expected.max = max(expected.max, box.max);
    const Box all = world_bounds(scene);
    ASSERT_EQ(all.min, expected.min) << i;
    ASSERT_EQ(all.max, expected.max) << i;
  }
}

}  // namespace
}  // namespace raysheaf
