// Materials whose alpha cuts holes into surfaces. `M`: `Material`, or the renderer's form of it.
#pragma once

#include <algorithm>

#include "base/host_device.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

/// Whether alpha is a probability. `blends`: there are several samples per pixel, or the mesh's
/// vertices have alphas.
template <class M>
RAYSHEAF_HD inline bool is_by_chance(const M& m, bool blends) {
  return blends && m.alpha_blend;
}

/// The least alpha that is not a hole where alpha is no probability. A material that blends is
/// invisible where alpha is 0, as it would be by chance.
template <class M>
RAYSHEAF_HD inline float least_alpha(const M& m) {
  constexpr float kAboveZero = 0x1p-25f;  // the least result of chance_of
  return m.alpha_blend && m.alpha_cutoff < kAboveZero ? kAboveZero : m.alpha_cutoff;
}

/// Whether any point may be a hole. `alpha`: the material's own; `blends`: there are several
/// samples per pixel; `has_alphas`: the mesh's vertices have alphas.
template <class M>
RAYSHEAF_HD inline bool is_cutout(const M& m, float alpha, bool blends, bool has_alphas) {
  const float whole = is_by_chance(m, blends || has_alphas) ? 1 : least_alpha(m);
  const bool varies = has_alphas || m.base_color_texture.texture != kInvalidId;
  return whole > 0 && (varies || alpha < whole);
}

/// `blends`: there are several samples per pixel.
[[nodiscard]] inline bool has_cutouts(const SceneDescription& scene, bool blends) {
  const bool has_alphas = std::any_of(scene.meshes.begin(), scene.meshes.end(),
                                      [](const Mesh& mesh) { return !mesh.alphas.empty(); });
  return std::any_of(scene.materials.begin(), scene.materials.end(), [&](const Material& material) {
    return is_cutout(material, material.base_color.w, blends, has_alphas);
  });
}

}  // namespace raysheaf
