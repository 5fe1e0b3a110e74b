// sRGB's transfer curve.
#pragma once

#include <cmath>

namespace raysheaf::io {

/// From 0 to 1 both (IEC 61966-2-1).
inline double linear_of_srgb(double x) {
  return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

}  // namespace raysheaf::io
