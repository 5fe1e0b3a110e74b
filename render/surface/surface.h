// The surface at a hit: position, normals, reflectances.
#pragma once

#include "render/surface/texture.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// A point of a surface, seen along a ray.
struct Surface {
  Vec3 position;          ///< world space; interpolated from the triangle's corners
  Vec3 geometric_normal;  ///< unit, on the ray's side
  /// Unit shading normal; without a normal texture, on the side of the geometric one. It may still
  /// point away from the ray.
  Vec3 normal;
  Vec3 diffuse;   ///< reflectance
  Vec3 specular;  ///< reflectance along the normal
  Vec3 coat;      ///< the part of `specular` that reduces the diffuse light below: without the
                  ///< metal's
  float specular_edge = 1, coat_edge = 1;  ///< the same at grazing angles: glTF's F90
  Vec3 transmission_color;
  Vec3 emission;           ///< radiance
  float roughness = 1;     ///< glTF's, before it is squared
  float transmission = 0;  ///< the fraction of the unreflected light that is transmitted
  float ior = 1.5f;        ///< at least 1, of the inside relative to the outside
  float clearance = 0;     ///< minimum distance along the geometric normal at which rays that leave
                           ///< the surface start
  bool unlit = false;      ///< `emission` is the only visible part
  bool thin = false;       ///< a transmitting surface without an interior
  bool front = true;       ///< the ray hits the front face
  std::uint32_t material = kInvalidId;
};

/// The surface at barycentric weights `u`, `v` of corners 1 and 2 of a triangle of the flat scene,
/// for a ray along `direction`. `textures` are those of the scene's description. O(1), no
/// allocation.
///
/// Reflectances follow glTF 2.0 (appendix B) with KHR_materials_ior, _specular and _transmission.
/// An ior of 0, which means "reflect everything", becomes 1, and `specular` holds the reflectance
/// that it implies.
[[nodiscard]] Surface surface_at(const FlatScene& scene, const TextureSet& textures,
                                 std::uint32_t triangle, float u, float v, Vec3 direction);

/// All data of a triangle that its surface needs, independent of where it is stored.
struct SurfaceTriangle {
  Vec3 corner[3];  ///< world space
  Vec3 normal[3];  ///< in the instance's own space
  Vec2 uv[3], second_uv[3];
  Vec3 color[3];
  float alpha[3] = {1, 1, 1};
  bool has_normals = false, has_uvs = false, has_second_uvs = false, has_colors = false;
  bool has_alphas = false;
  bool mirrored = false;  ///< by the instance
  Affine to_world;        ///< of the instance
  std::uint32_t material = kInvalidId;
};

/// As `surface_at`, for a single triangle; `scene` provides its materials.
[[nodiscard]] Surface surface_of(const SceneDescription& scene, const TextureSet& textures,
                                 const SurfaceTriangle& triangle, float u, float v, Vec3 direction);

}  // namespace raysheaf
