// Materials whose alpha says where there is nothing.
#pragma once

#include <algorithm>

#include "raysheaf/scene_description.h"

namespace raysheaf {

/// Whether any place may be cut away. `blends`: there are several samples a pixel.
[[nodiscard]] inline bool is_cutout(const Material& material, bool blends) {
  const float whole = blends && material.alpha_blend ? 1 : material.alpha_cutoff;
  const bool varies = material.base_color_texture.texture != kInvalidId;
  return whole > 0 && (varies || material.base_color.w < whole);
}

[[nodiscard]] inline bool has_cutouts(const SceneDescription& scene, bool blends) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [blends](const Material& material) { return is_cutout(material, blends); });
}

}  // namespace raysheaf
