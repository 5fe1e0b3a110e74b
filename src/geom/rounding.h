// Conversions from double to float with a chosen direction of rounding.
#pragma once

#include <cmath>
#include <limits>

#include "base/host_device.h"

namespace raysheaf {

/// The nearest float, as a value that may be compared with `x` in double. The volatile is needed
/// because GCC 12 vectorises pairs of conversions to float and back, and then removes both.
RAYSHEAF_HD inline float rounded(double x) {
  const volatile float stored = static_cast<float>(x);
  return stored;
}

/// The least float that is not below `x`.
RAYSHEAF_HD inline float rounded_up(double x) {
  const float nearest = rounded(x);
  return static_cast<double>(nearest) >= x
             ? nearest
             : std::nextafter(nearest, std::numeric_limits<float>::infinity());
}

}  // namespace raysheaf
