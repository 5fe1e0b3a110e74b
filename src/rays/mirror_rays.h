// Mirror rays, many at a time: those of `make_bounce_rays`, SIMD over the rays.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "rays/fragment.h"
#include "rays/point_light.h"

namespace raysheaf {

/// The reflections that leave fragments[slots[i]], 1 to `kLightBlock` of them, and what their
/// pixels receive of the radiance along them. A bit of `odd`, which has a word for `kLightLanes`
/// rays each, is set where nothing of a ray is right: glass, and vectors of odd lengths, are for
/// the scalar functions. Chosen at run time.
void make_mirror_rays(View<const Fragment> fragments, View<const std::uint32_t> slots, Ray* rays,
                      Vec3* weights, std::uint16_t* odd);

}  // namespace raysheaf
