// Small scenes with light and camera, and helpers to render and compare them.
#pragma once

#include <cstring>

#include "base/vec.h"
#include "raysheaf/render.h"
#include "raysheaf/scene_description.h"
#include "support/random.h"
#include "support/soups.h"

namespace raysheaf::test {

/// A smooth sphere of `rings` rings; front faces point outwards.
inline Mesh ball(std::uint32_t rings, float radius, Vec3 center = {0, 0, 0}) {
  constexpr float kTurn = 6.28318530718f;
  Mesh mesh;
  const std::uint32_t segments = 2 * rings;
  for (std::uint32_t r = 0; r <= rings; ++r) {
    for (std::uint32_t s = 0; s <= segments; ++s) {
      const float polar = 0.5f * kTurn * static_cast<float>(r) / static_cast<float>(rings);
      const float around = kTurn * static_cast<float>(s % segments) / static_cast<float>(segments);
      const Vec3 n{std::sin(polar) * std::sin(around), std::cos(polar),
                   std::sin(polar) * std::cos(around)};
      mesh.positions.push_back(center + n * radius);
      mesh.normals.push_back(n);
    }
  }
  for (std::uint32_t r = 0; r < rings; ++r) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const std::uint32_t a = r * (segments + 1) + s, b = a + segments + 1;
      if (r > 0) mesh.triangles.push_back({a, b, a + 1});
      if (r + 1 < rings) mesh.triangles.push_back({a + 1, b, b + 1});
    }
  }
  return mesh;
}

inline Mesh floor_square(float half, float y) {
  Mesh mesh;
  mesh.positions = {{-half, y, -half}, {half, y, -half}, {half, y, half}, {-half, y, half}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  return mesh;
}

inline Light point_light(Vec3 position, float intensity) {
  Light light;
  light.position = position;
  light.intensity = {intensity, intensity, intensity};
  return light;
}

inline Camera camera_at(Vec3 eye, Vec3 target) {
  Camera camera;
  camera.to_world = look_at(eye, target, {0, 1, 0});
  camera.z_near = 1e-3f * length(target - eye);
  return camera;
}

/// A sphere over a floor, with a point light above.
inline SceneDescription ball_on_floor(Material material = {}) {
  SceneDescription scene;
  scene.materials.push_back(std::move(material));
  Mesh sphere = ball(24, 1, {0, 1, 0});
  sphere.materials = {0};
  add_mesh(&scene, std::move(sphere));
  add_mesh(&scene, floor_square(6, 0));
  scene.lights.push_back(point_light({2, 6, 3}, 100));
  scene.cameras.push_back(camera_at({0, 2.5f, 6}, {0, 0.8f, 0}));
  return scene;
}

/// Adds a double-sided wall at z with cut-outs: some texels of its texture, at random, have zero or
/// half alpha.
inline void add_curtain(SceneDescription* scene, float z, std::uint32_t seed) {
  constexpr std::uint32_t kTexels = 8;
  Random random(seed);
  Image image;
  image.width = image.height = kTexels;
  for (std::uint32_t i = 0; i < kTexels * kTexels; ++i)
    for (const std::uint32_t c : {200u, 255u, 100u, 127 * random.below(3)})
      image.rgba.push_back(static_cast<std::uint8_t>(c));
  const auto texture = static_cast<std::uint32_t>(scene->textures.size());
  const auto material = static_cast<std::uint32_t>(scene->materials.size());
  scene->textures.push_back({static_cast<std::uint32_t>(scene->images.size()), Wrap::kRepeat,
                             Wrap::kRepeat, seed % 2 == 0 ? Filter::kNearest : Filter::kLinear});
  scene->images.push_back(image);
  Material cut;
  cut.base_color_texture.texture = texture;
  cut.alpha_cutoff = 0.4f;
  cut.double_sided = true;
  scene->materials.push_back(cut);
  Mesh wall;
  wall.positions = {{-2, 0, z}, {2, 0, z}, {2, 2.5f, z}, {-2, 2.5f, z}};
  wall.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  wall.materials = {material};
  add_mesh(scene, std::move(wall));
}

inline RenderOptions small_options(std::uint32_t size = 48) {
  RenderOptions options;
  options.width = options.height = size;
  options.primary = Primary::kTrace;
  return options;
}

inline bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

}  // namespace raysheaf::test
