// Shading by point lights, many fragments at a time: `lit_by` (shade_body.h) of `sample_point`
// (render/rays/light_body.h), SIMD over the fragments.
#pragma once

#include <cstdint>

#include "render/rays/point_light.h"

namespace raysheaf {

/// The shading data of up to `kLightBlock` fragments; lanes after the last repeat the first.
struct ShadingColumns {
  alignas(64) float position[3][kLightBlock];
  float normal[3][kLightBlock], incoming[3][kLightBlock];
  float diffuse[3][kLightBlock], specular[3][kLightBlock], coat[3][kLightBlock];
  float specular_edge[kLightBlock], coat_edge[kLightBlock];
  // The values in `reflectance` that do not depend on the light.
  float cos_view[kLightBlock], alpha2[kLightBlock], masking[kLightBlock];
  float coat_view[3][kLightBlock];
  float radiance[3][kLightBlock];
};

/// The SIMD parts, chosen at run time. For 1 to `kLightBlock` fragments, each with its radiance so
/// far.
void gather_shading(View<const Fragment> fragments, const Vec3* radiance, ShadingColumns* columns);
/// Stores the radiance of the first lanes.
void give_radiance(const ShadingColumns& columns, View<Vec3> radiance);
/// Adds the light to the fragments whose `visible` is `Visibility::kVisible`; `visible` has
/// `kLightBlock` entries.
void add_point_light(const PlacedLight& light, View<const Fragment> fragments,
                     const std::uint8_t* visible, ShadingColumns* columns);

}  // namespace raysheaf
