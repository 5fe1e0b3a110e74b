// Leaving a surface without meeting it again.
//
// A hit point errs from its plane by `position_error` along each axis (scene/surface.h), and the t
// of a later test errs by a few roundings of the largest coordinate difference in it, which is
// bounded by the same error for geometry near the point and by the distance travelled for the far
// end. The point is moved along the geometric normal by a multiple of both, so that the offset
// follows the size of the numbers and not a constant in scene units (C. Waechter, N. Binder, "A
// Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems, 2019, chapter 6;
// pbrt-v4, section 6.8.6).
#pragma once

#include "base/float.h"
#include "scene/surface.h"

namespace raysheaf {

/// Multiples that leave room for the edge functions, whose errors at grazing angles exceed those of
/// the point itself; tests/raygen shades convex bodies at scales from 1e-3 to 1e3 without a
/// self-hit.
inline constexpr float kOffsetErrors = 16;
inline constexpr float kOffsetRoundings = 32;

/// How far a box of half size 1 reaches along `normal`.
RAYSHEAF_HD inline float offset_extent(Vec3 normal) {
  return std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z);
}

/// The point moved off the surface to the side that `direction` leaves to; `distance` is how far
/// the ray is known to come from or go to, or 0.
RAYSHEAF_HD inline Vec3 offset_point(const Surface& surface, Vec3 direction, float distance) {
  const Vec3 n = surface.geometric_normal;
  const float step = kOffsetErrors * surface.position_error * offset_extent(n) +
                     kOffsetRoundings * kUnitRoundoff * distance;
  return surface.position + n * (dot(direction, n) < 0 ? -step : step);
}

}  // namespace raysheaf
