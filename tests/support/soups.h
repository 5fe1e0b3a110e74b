// Adversarial scenes: random, needle-shaped, coplanar, repeated, degenerate, far away.
#pragma once

#include <string>
#include <vector>

#include "raysheaf/scene_description.h"
#include "support/random.h"

namespace raysheaf::test {

inline void add_triangle(Mesh* mesh, Vec3 a, Vec3 b, Vec3 c) {
  const auto first = static_cast<std::uint32_t>(mesh->positions.size());
  mesh->positions.insert(mesh->positions.end(), {a, b, c});
  mesh->triangles.push_back({first, first + 1, first + 2});
}

inline void add_mesh(SceneDescription* scene, Mesh mesh) {
  Instance instance;
  instance.mesh = static_cast<std::uint32_t>(scene->meshes.size());
  scene->meshes.push_back(std::move(mesh));
  scene->instances.push_back(instance);
}

enum class SoupKind {
  kSmall,
  kLarge,
  kNeedles,
  kSlivers,
  kCoplanar,
  kDuplicates,
  kZeroArea,
  kFar,
  kTiny
};

inline const std::vector<SoupKind>& soup_kinds() {
  static const std::vector<SoupKind> kinds{
      SoupKind::kSmall,    SoupKind::kLarge,    SoupKind::kNeedles,
      SoupKind::kSlivers,  SoupKind::kCoplanar, SoupKind::kDuplicates,
      SoupKind::kZeroArea, SoupKind::kFar,      SoupKind::kTiny};
  return kinds;
}

/// Draws numbers one after the other, because compilers evaluate the arguments of a call in
/// different orders.
inline void add_soup_triangle(Mesh* mesh, SoupKind kind, Random& random) {
  const Vec3 p = random.in_box(10);
  switch (kind) {
    case SoupKind::kSmall: {
      const Vec3 c = p + random.in_box(1), b = p + random.in_box(1);
      add_triangle(mesh, p, b, c);
      break;
    }
    case SoupKind::kLarge: {
      const Vec3 c = random.in_box(20), b = random.in_box(20);
      add_triangle(mesh, p, b, c);
      break;
    }
    case SoupKind::kNeedles: {
      const Vec3 c = p + random.in_box(1e-3f), b = p + random.in_box(8);
      add_triangle(mesh, p, b, c);
      break;
    }
    case SoupKind::kSlivers: {
      const Vec3 along = random.in_box(5);
      add_triangle(mesh, p, p + along, p + along * 0.5f + random.in_box(1e-5f));
      break;
    }
    case SoupKind::kCoplanar: {
      const Vec3 flat{p.x, 1, p.z};
      const Vec3 c = flat + Vec3{random.between(-3, 3), 0, random.between(-3, 3)};
      const Vec3 b = flat + Vec3{random.between(-3, 3), 0, random.between(-3, 3)};
      add_triangle(mesh, flat, b, c);
      break;
    }
    case SoupKind::kDuplicates: {
      const Vec3 q{std::floor(p.x), std::floor(p.y), 0};
      add_triangle(mesh, q, q + Vec3{2, 0, 0}, q + Vec3{0, 2, 0});
      break;
    }
    case SoupKind::kZeroArea: {
      const Vec3 along = random.in_box(4);
      if (random.below(2) == 0) {
        add_triangle(mesh, p, p + along, p + along);
      } else {
        const Vec3 q{1, 2, 3};
        add_triangle(mesh, q, q + Vec3{2, 4, 8}, q + Vec3{1, 2, 4});
      }
      break;
    }
    case SoupKind::kFar: {
      const Vec3 far = p + Vec3{1e5f, -2e5f, 3e5f};
      const Vec3 c = far + random.in_box(3), b = far + random.in_box(3);
      add_triangle(mesh, far, b, c);
      break;
    }
    case SoupKind::kTiny: {
      const Vec3 small = p * 1e-12f;
      const Vec3 c = small + random.in_box(3e-12f), b = small + random.in_box(3e-12f);
      add_triangle(mesh, small, b, c);
      break;
    }
  }
}

/// `triangles` of one kind, in meshes of about 40.
inline SceneDescription soup(SoupKind kind, std::uint32_t triangles, std::uint64_t seed) {
  Random random(seed);
  SceneDescription scene;
  while (triangles > 0) {
    Mesh mesh;
    const std::uint32_t count = std::min(triangles, 1 + random.below(80));
    for (std::uint32_t i = 0; i < count; ++i) add_soup_triangle(&mesh, kind, random);
    triangles -= count;
    add_mesh(&scene, std::move(mesh));
  }
  return scene;
}

/// Rays towards the scene's vertices, the midpoints of its edges, and anywhere; in bundles and
/// single.
inline std::vector<Ray> rays_at(const SceneDescription& scene, std::uint32_t count,
                                std::uint64_t seed) {
  Random random(seed);
  const Box box = world_bounds(scene);
  const Vec3 center = (box.min + box.max) * 0.5f, half = (box.max - box.min) * 0.75f;
  const auto somewhere = [&] { return center + random.in_box(1) * half; };
  std::vector<Ray> rays;
  Vec3 origin = somewhere();
  for (std::uint32_t i = 0; i < count; ++i) {
    if (random.below(16) == 0) origin = somewhere();
    const Mesh& mesh = scene.meshes[random.below(static_cast<std::uint32_t>(scene.meshes.size()))];
    const auto& corners =
        mesh.triangles[random.below(static_cast<std::uint32_t>(mesh.triangles.size()))];
    const Vec3 a = mesh.positions[corners[0]], b = mesh.positions[corners[1]];
    Vec3 target = somewhere();
    if (const std::uint32_t aim = random.below(4); aim == 0)
      target = a;
    else if (aim == 1)
      target = (a + b) * 0.5f;
    Vec3 direction = target - origin;
    if (!(max_component(abs(direction)) > 0)) direction = {1, 0, 0};
    const bool finite = random.below(3) == 0;
    rays.push_back({origin, 0, direction,
                    finite ? random.between(0.5f, 2) : std::numeric_limits<float>::infinity()});
  }
  return rays;
}

}  // namespace raysheaf::test
