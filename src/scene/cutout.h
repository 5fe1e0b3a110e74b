// Materials whose alpha says where there is nothing.
#pragma once

#include <algorithm>

#include "raysheaf/scene_description.h"

namespace raysheaf {

/// Whether any place may be cut away.
[[nodiscard]] inline bool is_cutout(const Material& material) {
  return material.alpha_cutoff > 0 && (material.base_color_texture.texture != kInvalidId ||
                                       material.base_color.w < material.alpha_cutoff);
}

[[nodiscard]] inline bool has_cutouts(const SceneDescription& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(), is_cutout);
}

}  // namespace raysheaf
