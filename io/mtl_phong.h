// Converts the Phong parameters of MTL materials to the metallic-roughness model.
#pragma once

#include "raysheaf/scene_description.h"

namespace tinyobj {
struct material_t;
}  // namespace tinyobj

namespace raysheaf::io {

enum class MtlLook {
  kGlass,   ///< clear glass, tinted by its filter
  kTinted,  ///< glass by d and Ni only, tinted by its diffuse colour
  kMirror,
  kConstant,  ///< an unlit colour
  kGlossy,
};
[[nodiscard]] MtlLook look_of(const tinyobj::material_t& m);

/// Converts a material without its maps.
[[nodiscard]] Material material_of(const tinyobj::material_t& m);

/// Clamps negative and non-finite components to 0.
[[nodiscard]] Vec3 mtl_color(const float* rgb);
/// Ks; black for illumination models 0 and 1, which have no highlights.
[[nodiscard]] Vec3 mtl_specular(const tinyobj::material_t& m);
[[nodiscard]] float largest_part(Vec3 color);

}  // namespace raysheaf::io
