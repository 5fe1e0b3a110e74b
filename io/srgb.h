// sRGB's transfer curve and primaries (IEC 61966-2-1).
#pragma once

#include <cmath>

#include "io/linear.h"

namespace raysheaf::io {

/// If a float colour has a larger component, the file's colours range to 255, as bytes do. It
/// exceeds 1 so that a rounded white stays white.
inline constexpr float kMostUnitColor = 1.001f;
inline constexpr const char* kBytesRemark =
    "Colours exceed 1; they are taken for bytes and divided by 255.";

/// Both are in the range from 0 to 1.
inline double linear_of_srgb(double x) {
  return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

/// The inverse of `linear_of_srgb`.
inline double srgb_of_linear(double x) {
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

/// Converts CIE 1931 XYZ, in which (0.95047, 1, 1.08883) is white, to linear RGB. Colours outside
/// the display's range have negative components.
inline Double3 rgb_of_xyz(Double3 xyz) {
  return {dot({3.2404542, -1.5371385, -0.4985314}, xyz),
          dot({-0.9692660, 1.8760108, 0.0415560}, xyz),
          dot({0.0556434, -0.2040259, 1.0572252}, xyz)};
}

}  // namespace raysheaf::io
