// Surfaces of triangles that are requested one after the other, as by pixels.
//
// Neighbouring pixels often see the same triangle, more often the same mesh, and most often the
// same material: values that depend only on these are computed when they change, not for every
// point.
#pragma once

#include "geom/surface_body.h"
#include "render/surface/material_body.h"
#include "render/surface/surface.h"

namespace raysheaf {

/// `surface_at` and `surface_of` (render/surface/surface.h), bit for bit. Not thread-safe.
class SurfaceReader {
 public:
  /// Both must outlive it and not change.
  SurfaceReader(const SceneDescription& scene, const TextureSet& textures)
      : scene_(scene), textures_(textures) {}

  /// Sets the triangle for `at`: one of a flat scene, always the same one, or any single triangle.
  void hold(const FlatScene& flat, TriangleAt at);
  void hold(const SurfaceTriangle& triangle);
  [[nodiscard]] const SurfaceTriangle& held() const { return t_; }

  /// The surface at the weights of the second and third corner, for a ray along `direction`.
  [[nodiscard]] Surface at(float u, float v, Vec3 direction) const;
  /// The base colour's alpha there, times the texture's and the vertices'.
  [[nodiscard]] float alpha_at(float u, float v) const;

 private:
  void hold_material(std::uint32_t material);

  const SceneDescription& scene_;
  const TextureSet& textures_;
  SurfaceTriangle t_;
  TriangleAt at_;  ///< in the flat scene
  NormalMap normal_map_;
  Vec3 front_;  ///< of the front side; zero if there is no area
  PlacedMaterial material_;
  bool has_material_ = false;
  bool textured_ = false;
  Surface look_;  ///< the material's part of every surface, if the material looks the same
                  ///< everywhere
};

}  // namespace raysheaf
