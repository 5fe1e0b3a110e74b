// Which transforms reverse the winding of triangles.
#pragma once

#include <cmath>

#include "base/exact_sum_body.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// `mirrors` where binary64 does not decide.
RAYSHEAF_HD_CALLED inline bool mirrors_exactly(const Affine& a) {
  ExactSum sum;  // products of two floats are exact
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double x = a.m[0][i];
    sum.add_product(x, static_cast<double>(a.m[1][j]) * a.m[2][k]);
    sum.add_product(-x, static_cast<double>(a.m[1][k]) * a.m[2][j]);
  }
  return sum.sign() < 0;
}

/// Whether the determinant is negative, exactly. No term overflows or underflows in binary64: a
/// product of three floats is a multiple of 2^-447 and below 2^384.
RAYSHEAF_HD inline bool mirrors(const Affine& a) {
  double value = 0, size = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double left = static_cast<double>(a.m[1][j]) * a.m[2][k];
    const double right = static_cast<double>(a.m[1][k]) * a.m[2][j];
    value += a.m[0][i] * (left - right);
    size += std::fabs(static_cast<double>(a.m[0][i])) * (std::fabs(left) + std::fabs(right));
  }
  // A term passes through a difference, a product and two sums: 4 roundings of at most 2^-53, and
  // `size` through as many. 0x1p-50 is twice that bound.
  if (std::fabs(value) > 0x1p-50 * size) return value < 0;
  return mirrors_exactly(a);
}

}  // namespace raysheaf
