// Rounding errors of binary32.
#pragma once

#include "base/bits.h"
#include "base/host_device.h"

namespace raysheaf {

/// Half an ulp of 1: the relative error of one correctly rounded operation.
inline constexpr float kUnitRoundoff = 0x1p-24f;

/// Bounds the relative error of `n` operations in a row: n u / (1 - n u) (Higham 2002,
/// section 3.1).
RAYSHEAF_HD constexpr float gamma(int n) {
  return (static_cast<float>(n) * kUnitRoundoff) / (1 - static_cast<float>(n) * kUnitRoundoff);
}

}  // namespace raysheaf
