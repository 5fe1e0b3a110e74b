// Phong's numbers of an MTL material, as metallic-roughness.
#pragma once

#include "raysheaf/scene_description.h"

namespace tinyobj {
struct material_t;
}  // namespace tinyobj

namespace raysheaf::io {

enum class MtlLook {
  kGlass,   ///< clear, in the colour of its filter
  kTinted,  ///< glass by d and Ni alone: it has the colour of its body
  kMirror,
  kConstant,  ///< its colour, whatever the light
  kGlossy,    ///< everything else
};
[[nodiscard]] MtlLook look_of(const tinyobj::material_t& m);

/// Without its maps.
[[nodiscard]] Material material_of(const tinyobj::material_t& m);

/// Three parts, those taken for 0 that are below it or not finite.
[[nodiscard]] Vec3 mtl_color(const float* rgb);
/// Ks; black in models 0 and 1, which have no highlights.
[[nodiscard]] Vec3 mtl_specular(const tinyobj::material_t& m);
[[nodiscard]] float largest_part(Vec3 color);

}  // namespace raysheaf::io
