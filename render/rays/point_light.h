// Point lights, for many fragments at a time.
//
// Most shadow rays go to such lights, and `sample_point` (light_body.h) takes six divisions and a
// square root. SIMD kernels compute it for 16 fragments at once, with the same operations in the
// same order; fragments are stored in columns before, once for all lights.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "render/rays/fragment.h"
#include "render/rays/light_body.h"

namespace raysheaf {

inline constexpr std::size_t kLightLanes = 16;
/// Number of fragments in columns: with all their shading data, they stay in the first-level cache
/// while they are lit by light after light.
inline constexpr std::size_t kLightBlock = 256;
inline constexpr std::size_t kLightGroups = kLightBlock / kLightLanes;

/// Whether the sample treats the light as a point, by `sample_point`.
inline bool shines_from_point(const PlacedLight& light, SampleOf sample) {
  if (light.is_directional || light.is_rectangle) return false;
  return !has_size(light) || sample.count == 1;
}

/// The data of up to `kLightBlock` fragments for shadow rays; lanes after the last repeat the
/// first.
struct ShadowColumns {
  alignas(64) float position[3][kLightBlock];
  float normal[3][kLightBlock];
  float outward[3][kLightBlock];  ///< the geometric normal
  float clearance[kLightBlock];
  std::uint16_t lit[kLightGroups];  ///< one bit per fragment: light falls on it
};

/// The SIMD parts, chosen at run time. `fragments`: 1 to `kLightBlock`, those of the columns.
void gather_shadow_columns(View<const Fragment> fragments, ShadowColumns* columns);
/// Sets a bit for each fragment that has a shadow ray to the light; returns how many.
std::uint32_t find_facing(const ShadowColumns& columns, const PlacedLight& light,
                          View<const Fragment> fragments, std::uint16_t* facing);
/// Makes the rays of the fragments that `facing` names, consecutively.
void make_point_rays(const ShadowColumns& columns, const PlacedLight& light,
                     View<const Fragment> fragments, const std::uint16_t* facing, Ray* rays);

}  // namespace raysheaf
