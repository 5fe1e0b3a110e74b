// Small scenes, and random ones.
#pragma once

#include <random>

#include "base/vec.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::test {

using Random = std::mt19937;

inline float uniform(Random& random, float low, float high) {
  return std::uniform_real_distribution<float>(low, high)(random);
}
inline std::uint32_t below(Random& random, std::uint32_t count) {
  return static_cast<std::uint32_t>(random() % count);
}
inline Vec3 random_point(Random& random, float scale) {
  return {uniform(random, -scale, scale), uniform(random, -scale, scale),
          uniform(random, -scale, scale)};
}

/// An affine map of any kind: rotated, sheared, mirrored, flattened, tiny, huge, far away.
inline Affine random_map(Random& random) {
  Affine map;
  for (auto& row : map.m) {
    const float row_scale = std::pow(10.0f, uniform(random, -3, 3));
    for (float& x : row) x = uniform(random, -1, 1) * row_scale;
    if (random() % 4 == 0) row[3] *= 1e6f;
  }
  if (random() % 5 == 0) map.m[random() % 3] = {0, 0, 0, uniform(random, -1, 1)};
  if (random() % 5 == 0) map.m[1] = map.m[0];
  return map;
}

/// One triangle, one instance.
inline SceneDescription one_triangle() {
  SceneDescription scene;
  Mesh mesh;
  mesh.name = "Chair";
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  scene.meshes.push_back(mesh);
  scene.instances.push_back({});
  return scene;
}

/// A mesh of random triangles; every eighth vertex repeats another.
inline Mesh random_mesh(Random& random, std::uint32_t vertices, std::uint32_t triangles,
                        float scale) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < vertices; ++i) {
    mesh.positions.push_back(i % 8 == 7 ? mesh.positions[random() % i]
                                        : random_point(random, scale));
  }
  for (std::uint32_t i = 0; i < triangles; ++i) {
    mesh.triangles.push_back(
        {below(random, vertices), below(random, vertices), below(random, vertices)});
  }
  return mesh;
}

}  // namespace raysheaf::test
