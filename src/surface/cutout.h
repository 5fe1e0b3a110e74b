// Materials whose alpha cuts holes into surfaces.
#pragma once

#include <algorithm>

#include "raysheaf/scene_description.h"
#include "surface/material_body.h"

namespace raysheaf {

/// `blends`: there are several samples per pixel.
[[nodiscard]] inline bool has_cutouts(const SceneDescription& scene, bool blends) {
  const bool has_alphas = std::any_of(scene.meshes.begin(), scene.meshes.end(),
                                      [](const Mesh& mesh) { return !mesh.alphas.empty(); });
  return std::any_of(scene.materials.begin(), scene.materials.end(), [&](const Material& material) {
    return is_cutout(placed_material(material), blends, has_alphas);
  });
}

}  // namespace raysheaf
