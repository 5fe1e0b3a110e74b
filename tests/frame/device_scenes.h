// Scenes for the tests of frames on a device.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "raysheaf/render.h"
#include "support/pictures.h"
#include "support/same_picture.h"
#include "support/scenes.h"

namespace raysheaf {

/// Everything that frames on a device support, in one scene: textures that are rotated, scaled and
/// mirrored, glass, a mirror, metal, lamps, a mirrored instance, triangles without material, normal
/// or area, and all kinds of lights; `soft` adds a sphere and a rectangle.
inline SceneDescription motley(std::uint32_t seed, bool soft = false) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  SceneDescription scene = test::ball_on_floor();
  for (std::uint32_t i = 0; i < 2; ++i) {
    Image image;
    image.width = 5 + i;
    image.height = 3;
    for (std::uint32_t k = 0; k < image.width * image.height * 4; ++k)
      image.rgba.push_back(static_cast<std::uint8_t>(random() & 255));
    scene.images.push_back(image);
    scene.textures.push_back({i, static_cast<Wrap>(i), Wrap::kMirroredRepeat,
                              i == 0 ? Filter::kLinear : Filter::kNearest});
  }
  for (std::uint32_t i = 0; i < 8; ++i) {
    Material material;
    material.base_color = {unit(random), unit(random), unit(random), 1};
    if (i % 2 == 0)
      material.base_color_texture = {i / 2 % 2, {0.3f, 0.1f}, {2, 3}, 0.7f * static_cast<float>(i)};
    if (i % 3 == 0) material.metallic_roughness_texture.texture = 1;
    if (i == 5) material.emission_texture.texture = 0;
    if (i % 4 < 2) material.normal_texture = {1, {0, 0}, {3, 1}, 0.3f};
    material.normal_scale = 0.4f * static_cast<float>(i);
    if (i == 5) material.emission = {2, 1, 0.5f};
    material.metallic = i % 4 == 1 ? 1.0f : 0.0f;
    material.roughness = i % 4 == 1 ? 0.02f : unit(random);
    material.transmission = i == 2 || i == 6 ? 0.9f : 0.0f;
    material.thin = i == 2;
    material.ior = i == 6 ? 0.0f : 1.4f;
    material.specular = unit(random);
    material.unlit = i == 7;
    material.double_sided = i % 3 != 2;
    scene.materials.push_back(material);
  }
  const auto materials = static_cast<std::uint32_t>(scene.materials.size());
  for (std::uint32_t i = 0; i < 8; ++i) {
    Mesh ball = test::ball(5, 0.4f);
    if (i % 2 == 0) ball.normals.clear();
    if (i != 3)
      for (const Vec3 p : ball.positions) ball.uvs.push_back({2 * p.x, p.y - p.z});
    if (i % 3 != 0)
      for (const Vec3 p : ball.positions) ball.colors.push_back(abs(p) * 2);
    for (std::size_t t = 0; i > 4 && t < ball.triangles.size(); ++t)
      ball.materials.push_back(static_cast<std::uint32_t>(random() % materials));
    if (i == 4) ball.materials = {};
    if (i < 4) ball.materials = {materials - 1 - i};
    ball.triangles.push_back({1, 1, 2});
    if (i > 4) ball.materials.push_back(0);
    scene.meshes.push_back(ball);
    Instance placed;
    placed.mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
    for (int axis = 0; axis < 3; ++axis) {
      for (int c = 0; c < 3; ++c)
        placed.to_world.m[axis][c] = (axis == c ? 1.0f : 0.0f) + 0.4f * (unit(random) - 0.5f);
      placed.to_world.m[axis][3] = (axis == 1 ? 1.5f : 4) * unit(random) - (axis == 1 ? 0 : 2);
    }
    if (i % 3 == 0)
      for (auto& row : placed.to_world.m) row[0] = -row[0];
    scene.instances.push_back(placed);
    if (i == 6) scene.instances.push_back(placed);  // two instances in the same place
  }
  Light spot = test::point_light({2, 4, 1}, 60);
  spot.type = Light::Type::kSpot;
  spot.direction = {-0.4472136f, -0.8944272f, 0};
  spot.outer_angle = 0.6f;
  Light sun = test::point_light({0, 0, 0}, 1.5f);
  sun.type = Light::Type::kDirectional;
  sun.direction = {0.6f, -0.8f, 0};
  Light near = test::point_light({-1, 2, 2}, 10);
  near.range = 3;
  scene.lights.insert(scene.lights.end(), {spot, sun, near});
  if (!soft) return scene;
  scene.lights[0].radius = 0.3f;
  scene.lights[1].radius = 0.1f;
  Light plate = test::point_light({0, 3, -1}, 5);
  plate.type = Light::Type::kRectangle;
  plate.direction = {0, -1, 0};
  plate.right = {1, 0, 0};
  plate.width = 1.5f;
  plate.height = 0.5f;
  scene.lights.push_back(plate);
  return scene;
}

/// A sky with a small sun.
inline Environment motley_sky(float rotation) {
  Environment sky;
  sky.width = 8;
  sky.height = 4;
  sky.intensity = 0.7f;
  sky.rotation = rotation;
  for (std::uint32_t i = 0; i < sky.width * sky.height; ++i) {
    const float x = 0.03f * static_cast<float>(i);
    sky.radiance.push_back(i == 11 ? Vec3{30, 20, 10} : Vec3{x, 1 - x, 0.5f});
  }
  return sky;
}

/// Mirrors and glass in front of and behind curtains, one of which coincides with another, and a
/// pane with random cut-outs.
inline SceneDescription behind_curtains() {
  Material glass;
  glass.transmission = 0.7f;
  glass.roughness = 0;
  SceneDescription scene = test::ball_on_floor(glass);
  test::add_curtain(&scene, 1.5f, 1);
  test::add_curtain(&scene, 2, 2);
  test::add_curtain(&scene, 2, 3);
  Material mist;
  mist.alpha_blend = true;
  mist.double_sided = true;
  mist.base_color = {0.3f, 0.4f, 0.5f, 0.5f};
  scene.materials.push_back(mist);
  Mesh pane = test::floor_square(5, 1.2f);
  pane.materials = {static_cast<std::uint32_t>(scene.materials.size()) - 1};
  test::add_mesh(&scene, std::move(pane));
  return scene;
}

inline RenderOptions traced(std::uint32_t size) {
  RenderOptions options = test::small_options(size);
  options.primary = Primary::kTrace;
  options.bounces = 3;
  return options;
}

}  // namespace raysheaf
