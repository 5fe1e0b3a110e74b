// Which material a triangle has.
#pragma once

#include "raysheaf/scene_description.h"

namespace raysheaf {

/// Index into `SceneDescription::materials`, or `kInvalidId` for the default material.
inline std::uint32_t material_of(const Mesh& mesh, std::uint32_t prim_id) {
  if (mesh.materials.empty()) return kInvalidId;
  return mesh.materials.size() == 1 ? mesh.materials[0] : mesh.materials[prim_id];
}

inline const Material& material_or_default(const SceneDescription& scene, std::uint32_t index) {
  static const Material fallback;
  return index < scene.materials.size() ? scene.materials[index] : fallback;
}

}  // namespace raysheaf
