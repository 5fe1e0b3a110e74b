// The data from which surfaces are computed, in a device's format: arrays of plain values.
#pragma once

#include <cstdint>
#include <vector>

#include "geom/surface_body.h"
#include "render/rays/fragment.h"
#include "render/surface/material_body.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// An instance of a mesh. If a mesh lacks an attribute, its first index is undefined.
struct StagedMesh {
  std::uint32_t first_triangle = 0;  ///< of the flat scene
  std::uint32_t first_index = 0;     ///< of its geometry's first triangle
  std::uint32_t first_normal = 0, first_uv = 0, first_color = 0;
  std::uint32_t first_second_uv = 0, first_alpha = 0, first_position = 0;
  std::uint32_t first_material = 0, material_count = 0;  ///< one a triangle, or one for all
  bool has_normals = false, has_uvs = false, has_colors = false, mirrored = false;
  bool has_second_uvs = false, has_alphas = false;
  NormalMap normal_map;
};

struct StagedTriangle {
  std::uint32_t vertex[3];
};

/// `materials`: the scene's, followed by the default for triangles without a material.
struct StagedSceneView {
  View<const Vec3> corners;  ///< three per triangle of the flat scene, in world space
  View<const std::uint32_t> mesh_of_triangle;
  View<const StagedMesh> meshes;
  View<const StagedTriangle> triangles;  ///< of all geometries
  View<const Vec3> normals;              ///< of vertices, in their geometry's local space
  View<const Vec2> uvs, second_uvs;
  View<const Vec3> colors;
  View<const float> alphas;
  View<const std::uint32_t> material_numbers;
  View<const PlacedMaterial> materials;
  TextureTable textures;
};

/// The material of a triangle of the flat scene, as in `Surface::material`.
RAYSHEAF_HD inline std::uint32_t staged_material(const StagedSceneView& scene,
                                                 const StagedMesh& mesh, std::uint32_t triangle) {
  if (mesh.material_count == 0) return kInvalidId;
  const std::uint32_t prim_id = triangle - mesh.first_triangle;
  return scene.material_numbers
      .data[mesh.first_material + (mesh.material_count == 1 ? 0 : prim_id)];
}

RAYSHEAF_HD inline const PlacedMaterial& placed_material_of(const StagedSceneView& scene,
                                                            std::uint32_t number) {
  const std::uint64_t last = scene.materials.size - 1;
  return scene.materials.data[number < last ? number : last];
}

/// For a triangle whose mesh has texture coordinates.
RAYSHEAF_HD inline TriangleUv staged_uv(const StagedSceneView& scene, const StagedMesh& mesh,
                                        const StagedTriangle& vertices) {
  TriangleUv uv;
  for (int k = 0; k < 3; ++k) {
    uv.first[k] = scene.uvs.data[mesh.first_uv + vertices.vertex[k]];
    uv.second[k] = mesh.has_second_uvs
                       ? scene.second_uvs.data[mesh.first_second_uv + vertices.vertex[k]]
                       : uv.first[k];
  }
  return uv;
}

/// `surface_at` (render/surface/surface.h), bit for bit.
RAYSHEAF_HD inline Surface staged_surface(const StagedSceneView& scene, std::uint32_t triangle,
                                          float u, float v, Vec3 direction) {
  const StagedMesh& mesh = scene.meshes.data[scene.mesh_of_triangle.data[triangle]];
  const StagedTriangle vertices =
      scene.triangles.data[mesh.first_index + (triangle - mesh.first_triangle)];
  const std::uint64_t first_corner = std::uint64_t{3} * triangle;
  Vec3 corner[3], normal[3], color[3];
  TriangleUv uv;
  if (mesh.has_uvs) uv = staged_uv(scene, mesh, vertices);
  for (int k = 0; k < 3; ++k) {
    corner[k] = scene.corners.data[first_corner + static_cast<std::uint64_t>(k)];
    if (mesh.has_normals) normal[k] = scene.normals.data[mesh.first_normal + vertices.vertex[k]];
    if (mesh.has_colors) color[k] = scene.colors.data[mesh.first_color + vertices.vertex[k]];
  }
  Surface surface;
  surface.material = staged_material(scene, mesh, triangle);
  const PlacedMaterial& material = placed_material_of(scene, surface.material);
  TextureColors colors;
  if (mesh.has_uvs && !is_plain(material))
    colors = texture_colors(material, scene.textures, mixed(uv, u, v));
  if (mesh.has_colors) colors.base = colors.base * mixed(color, u, v);
  set_material(material, colors, &surface);
  const PlacedSurface placed =
      placed_surface(corner, front_normal(corner, mesh.mirrored),
                     mesh.has_normals ? &normal : nullptr, mesh.normal_map, u, v, direction);
  surface.position = placed.position;
  surface.geometric_normal = placed.geometric_normal;
  surface.normal = placed.normal;
  if (mesh.has_uvs && is_bumpy(material))
    surface.normal = textured_normal(material, scene.textures, corner, uv, u, v, placed);
  surface.clearance = placed.clearance;
  surface.front = placed.front;
  return surface;
}

/// The host's copy, ready to be uploaded, except for corners and textures.
struct StagedScene {
  std::vector<StagedMesh> meshes;
  std::vector<StagedTriangle> triangles;
  std::vector<Vec3> normals;
  std::vector<Vec2> uvs, second_uvs;
  std::vector<Vec3> colors;
  std::vector<float> alphas;
  std::vector<std::uint32_t> material_numbers;
  std::vector<PlacedMaterial> materials;
};

/// O(triangles + vertices). Throws Error (kUnsupported) above 2^32 vertices of all meshes.
[[nodiscard]] StagedScene stage_scene(const FlatScene& scene);

}  // namespace raysheaf
