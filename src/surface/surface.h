// What stands where a ray hits: place, normals, reflectances.
#pragma once

#include "scene/flat_scene.h"
#include "surface/texture.h"

namespace raysheaf {

/// A point of a surface, as the one who came along a ray meets it.
struct Surface {
  Vec3 position;          ///< world; the triangle's corners, mixed
  Vec3 geometric_normal;  ///< unit, on the side that the ray came from
  /// Unit shading normal; without a normal texture, on the side of the geometric one. It may still
  /// lean away from the ray.
  Vec3 normal;
  Vec3 diffuse;   ///< reflectance
  Vec3 specular;  ///< reflectance along the normal
  Vec3 coat;      ///< the part of it that shades what lies below: without the metal's
  float specular_edge = 1, coat_edge = 1;  ///< the same at grazing angles: glTF's F90
  Vec3 transmission_color;
  Vec3 emission;           ///< radiance
  float roughness = 1;     ///< glTF's, before it is squared
  float transmission = 0;  ///< the part of what is not reflected that goes through
  float ior = 1.5f;        ///< at least 1, inside against outside
  float clearance = 0;     ///< how far along the geometric normal rays that leave start, at least
  bool unlit = false;      ///< `emission` is all there is to see
  bool thin = false;       ///< what transmits has no inside
  bool front = true;       ///< the ray meets the front face
  std::uint32_t material = kInvalidId;
};

/// The surface at barycentric weights `u`, `v` of corners 1 and 2 of a triangle of the flat scene,
/// for a ray along `direction`. `textures` are those of the scene's description. O(1), no
/// allocation.
///
/// Reflectances follow glTF 2.0 (appendix B) with KHR_materials_ior, _specular and _transmission.
/// An ior of 0, which says "reflect all", is 1 here, with the reflectance that it means in
/// `specular`.
[[nodiscard]] Surface surface_at(const FlatScene& scene, const TextureSet& textures,
                                 std::uint32_t triangle, float u, float v, Vec3 direction);

/// All that a surface needs to know of its triangle, wherever that is.
struct SurfaceTriangle {
  Vec3 corner[3];  ///< world
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

/// The same of a triangle by itself; `scene` is asked for its materials.
[[nodiscard]] Surface surface_of(const SceneDescription& scene, const TextureSet& textures,
                                 const SurfaceTriangle& triangle, float u, float v, Vec3 direction);

}  // namespace raysheaf
