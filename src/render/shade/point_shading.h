// Points that shine on many fragments at a time: `lit_by` (shade_body.h) of `sample_point`
// (rays/light_body.h), SIMD over the fragments.
#pragma once

#include <cstdint>

#include "rays/point_light.h"

namespace raysheaf {

/// What shading needs of up to `kLightBlock` fragments; lanes behind the last are as the first.
struct ShadingColumns {
  alignas(64) float position[3][kLightBlock];
  float normal[3][kLightBlock], incoming[3][kLightBlock];
  float diffuse[3][kLightBlock], specular[3][kLightBlock], coat[3][kLightBlock];
  float specular_edge[kLightBlock], coat_edge[kLightBlock];
  // What `reflectance` says of a fragment whatever the light.
  float cos_view[kLightBlock], alpha2[kLightBlock], masking[kLightBlock];
  float coat_view[3][kLightBlock];
  float radiance[3][kLightBlock];
};

/// The SIMD parts, chosen at run time. Of 1 to `kLightBlock` fragments, each with its radiance
/// until now.
void gather_shading(View<const Fragment> fragments, const Vec3* radiance, ShadingColumns* columns);
/// The first lanes' radiance back.
void give_radiance(const ShadingColumns& columns, View<Vec3> radiance);
/// Adds what the light gives to the fragments whose `visible` is `Visibility::kVisible`; `visible`
/// has `kLightBlock` entries.
void add_point_light(const PlacedLight& light, View<const Fragment> fragments,
                     const std::uint8_t* visible, ShadingColumns* columns);

}  // namespace raysheaf
