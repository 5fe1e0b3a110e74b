// The published program's ray hash (Reis, Costa, Pereira 2017), including its errors; only the key
// `published` uses it.
//
//   shadow       31 30 29 ...... 20 19 .. 15 14 ....... 5 4 .... 0
//                |light|     0     | azimuth|      0     | polar |      + 1
//
//   reflection   azimuth and polar angle of the origin, then of the direction: fields of 7, 7, 7
//                and 5 bits from bit 19 down to bit 0; + 1
//   refraction   the same below the origin's distance from (0, 0, 0), at bit 26
//
// The light counts from 1 in two bits, so the fourth light wraps to 0. `as_coded` computes the
// azimuth as the program does, atan2(x, x), which depends only on the sign of x; otherwise it is
// atan2(y, x). Azimuths below -90 degrees become 0 in both cases. Origins are relative to the
// world's origin, not to the scene's box.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/vec.h"
#include "raysheaf/statistics.h"

namespace raysheaf {

/// Converts a float to an unsigned number of at most `most`; negative numbers and NaN become 0.
/// This is CUDA's conversion, on which the program relies.
RAYSHEAF_HD inline std::uint32_t saturated(float x, std::uint32_t most) {
  if (!(x > 0)) return 0;
  return x < static_cast<float>(most) ? static_cast<std::uint32_t>(x) : most;
}

/// Angles are computed in binary64 and rounded, because those of binary32 differ from processor to
/// processor.
RAYSHEAF_HD inline float published_azimuth(Vec3 v, bool as_coded) {
  constexpr float kHalfPi = 1.57079632679f;
  return static_cast<float>(std::atan2(double{as_coded ? v.x : v.y}, double{v.x})) + kHalfPi;
}

RAYSHEAF_HD inline std::uint32_t published_shadow_key(std::uint32_t light, Vec3 direction,
                                                      bool as_coded) {
  const Vec3 d = normalized(direction);
  return ((light + 1) << 30) + (saturated(published_azimuth(d, as_coded) * 5, 31) << 15) +
         saturated(static_cast<float>(std::acos(double{clamp(d.z, -1, 1)})) * 5, 31) + 1;
}

RAYSHEAF_HD inline std::uint32_t published_bounce_key(RayKind kind, Vec3 origin, Vec3 direction,
                                                      bool as_coded) {
  const Vec3 d = normalized(direction);
  const float distance = length(origin);
  const float height = distance > 0 ? clamp(origin.z / distance, -1, 1) : 1;
  std::uint32_t key = kind == RayKind::kRefraction ? saturated(distance, 128) : 0;
  key = key << 7 | saturated(published_azimuth(origin, as_coded) * 20, 128);
  key = key << 7 | saturated(static_cast<float>(std::acos(double{height})) * 20, 128);
  key = key << 7 | saturated(published_azimuth(d, as_coded) * 5, 30);
  return (key << 5 | saturated(static_cast<float>(std::acos(double{clamp(d.z, -1, 1)})) * 5, 30)) +
         1;
}

}  // namespace raysheaf
