// Which transforms reverse the winding of triangles.
#pragma once

#include "base/host_device.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// The determinant's sign, which in float may underflow.
RAYSHEAF_HD inline bool mirrors(const Affine& a) {
  const auto minor = [&](int i, int j) {
    return static_cast<double>(a.m[1][i]) * a.m[2][j] - static_cast<double>(a.m[1][j]) * a.m[2][i];
  };
  return a.m[0][0] * minor(1, 2) - a.m[0][1] * minor(0, 2) + a.m[0][2] * minor(0, 1) < 0;
}

}  // namespace raysheaf
