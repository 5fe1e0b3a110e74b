// Mirror rays, many at a time: those of `make_bounce_rays`, SIMD over the rays.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "render/rays/fragment.h"
#include "render/rays/point_light.h"

namespace raysheaf {

/// Makes the reflections that leave fragments[slots[i]], 1 to `kLightBlock` of them, and the
/// factors with which their radiance is added to their pixels. Sets a bit in `odd`, which has a
/// word for `kLightLanes` rays each, for each ray whose result is invalid: glass, and vectors of
/// unusual lengths, need the scalar functions. Chosen at run time.
void make_mirror_rays(View<const Fragment> fragments, View<const std::uint32_t> slots, Ray* rays,
                      Vec3* weights, std::uint16_t* odd);

}  // namespace raysheaf
