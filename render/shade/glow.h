// Glow of fragments, many at a time: `glow` (shade_body.h) and `rays_of`
// (render/rays/scatter_body.h), SIMD over the fragments.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "render/rays/fragment.h"
#include "render/rays/point_light.h"

namespace raysheaf {

/// The input that is the same for all fragments.
struct GlowLook {
  Vec3 sky;                ///< radiance of the uniform sky
  std::uint8_t kinds = 0;  ///< bits (`bit_of`) of the rays that are traced
};

/// Computes the radiance that leaves 1 to `kLightBlock` fragments, and in `going_on`, which may be
/// null, the rays that continue from them. Sets a bit in `odd`, which has a word for `kLightLanes`
/// fragments each, for each fragment whose result is invalid: glass needs the scalar functions.
/// Chosen at run time.
void find_glow(View<const Fragment> fragments, const GlowLook& look, Vec3* radiance,
               std::uint8_t* going_on, std::uint16_t* odd);

}  // namespace raysheaf
