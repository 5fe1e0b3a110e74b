// Converts the Phong parameters of MTL materials to the metallic-roughness model.
#pragma once

#include "io/mtl_statements.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

enum class MtlLook {
  kGlass,   ///< clear glass, tinted by its filter
  kTinted,  ///< glass by d and Ni only, tinted by its diffuse colour
  kMirror,
  kConstant,  ///< an unlit colour
  kGlossy,
};
[[nodiscard]] MtlLook look_of(const MtlMaterial& m);

/// Converts a material without its maps.
[[nodiscard]] Material material_of(const MtlMaterial& m);

/// Ks; black for illumination models 0 and 1, which have no highlights.
[[nodiscard]] Vec3 mtl_specular(const MtlMaterial& m);
[[nodiscard]] float largest_part(Vec3 color);

}  // namespace raysheaf::io
