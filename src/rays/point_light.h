// Lights that shine from a point, made ready for many fragments at a time.
//
// Most shadow rays go to such lights, and what `sample_point` (light_body.h) says of one costs six
// divisions and a root. SIMD kernels do it for 16 fragments at once, with its operations in its
// order; fragments are brought into columns before, once for all lights.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "rays/fragment.h"
#include "rays/light_body.h"

namespace raysheaf {

inline constexpr std::size_t kLightLanes = 16;
/// Fragments that are in columns at once: with all that shading needs of them, they stay in the
/// first cache while light after light looks at them.
inline constexpr std::size_t kLightBlock = 256;
inline constexpr std::size_t kLightGroups = kLightBlock / kLightLanes;

/// Whether the sample looks at the light as at a point, by `sample_point`.
inline bool shines_from_point(const PlacedLight& light, SampleOf sample) {
  if (light.is_directional || light.is_rectangle) return false;
  return !has_size(light) || sample.count == 1;
}

/// What shadow rays need of up to `kLightBlock` fragments; lanes behind the last are as the first.
struct ShadowColumns {
  alignas(64) float position[3][kLightBlock];
  float normal[3][kLightBlock];
  float outward[3][kLightBlock];  ///< the geometric normal
  float clearance[kLightBlock];
  std::uint16_t lit[kLightGroups];  ///< a bit a fragment: light falls on it
};

/// The SIMD parts, chosen at run time. `fragments`: 1 to `kLightBlock` of them, those of the
/// columns.
void gather_shadow_columns(View<const Fragment> fragments, ShadowColumns* columns);
/// A bit for each fragment that has a shadow ray to the light; returns how many.
std::uint32_t find_facing(const ShadowColumns& columns, const PlacedLight& light,
                          View<const Fragment> fragments, std::uint16_t* facing);
/// The rays of the fragments that `facing` names, one after the other.
void make_point_rays(const ShadowColumns& columns, const PlacedLight& light,
                     View<const Fragment> fragments, const std::uint16_t* facing, Ray* rays);

}  // namespace raysheaf
