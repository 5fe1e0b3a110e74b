// Offsets rays that leave a surface, so that they do not hit it again.
//
// A ray starts off the surface, along the geometric normal, by its `clearance`
// (geom/surface_body.h) and, if it comes from a light, by some roundings of that distance: one for
// each component of its direction, and one for t. Both are relative to the numbers; there is no
// constant in scene units (C. Waechter, N. Binder, "A Fast and Robust Method for Avoiding
// Self-Intersection", Ray Tracing Gems, 2019, chapter 6; pbrt-v4, section 6.8.6).
#pragma once

#include "base/float.h"
#include "render/surface/surface.h"

namespace raysheaf {

/// Roundings of the distance to a light: at most sqrt(3) and 1; in tests/raygen half of this value
/// suffices.
inline constexpr float kOffsetRoundings = 4;

/// The point, moved off the surface to the side to which `direction` leaves; `distance` is the
/// known length of the ray, or 0.
RAYSHEAF_HD inline Vec3 offset_point(const Surface& surface, Vec3 direction, float distance) {
  const Vec3 n = surface.geometric_normal;
  const float step = surface.clearance + kOffsetRoundings * kUnitRoundoff * distance;
  return surface.position + n * (dot(direction, n) < 0 ? -step : step);
}

}  // namespace raysheaf
