// Surfaces of triangles that are asked for one after the other, as pixels ask.
//
// Neighbours often lie on one triangle, oftener on one mesh, and oftenest on one material: what
// follows from either is worked out where it changes, and not for every point.
#pragma once

#include "surface/material_body.h"
#include "surface/surface.h"
#include "surface/surface_body.h"

namespace raysheaf {

/// `surface_at` and `surface_of` (surface/surface.h), bit for bit. Not for several threads at once.
class SurfaceReader {
 public:
  /// Both must outlive it, and stay as they are.
  SurfaceReader(const SceneDescription& scene, const TextureSet& textures)
      : scene_(scene), textures_(textures) {}

  /// The triangle that `at` is about, of always the same flat scene or of any place.
  void hold(const FlatScene& flat, std::uint32_t triangle);
  void hold(const SurfaceTriangle& triangle);
  [[nodiscard]] const SurfaceTriangle& held() const { return t_; }

  /// At the weights of its second and third corner, for a ray along `direction`.
  [[nodiscard]] Surface at(float u, float v, Vec3 direction) const;
  /// The base colour's alpha there, times the texture's and the vertices'.
  [[nodiscard]] float alpha_at(float u, float v) const;

 private:
  void hold_material(std::uint32_t material);

  const SceneDescription& scene_;
  const TextureSet& textures_;
  SurfaceTriangle t_;
  std::uint32_t triangle_ = kInvalidId, mesh_ = kInvalidId;  ///< of the flat scene
  NormalMap normal_map_;
  Vec3 front_;  ///< of the front side; nothing where there is no area
  PlacedMaterial material_;
  bool has_material_ = false;
  bool textured_ = false;
  Surface look_;  ///< the material's part of every surface; of one that looks the same everywhere
};

}  // namespace raysheaf
