// Sums without rounding, as expansions (J. Shewchuk, "Adaptive Precision Floating-Point Arithmetic
// and Fast Robust Geometric Predicates", 1997).
#pragma once

#include <cmath>

#include "base/host_device.h"

namespace raysheaf {

/// A sum of doubles and of products of two, without rounding.
class ExactSum {
 public:
  RAYSHEAF_HD void add(double x) {
    int size = 0;
    for (int i = 0; i < size_; ++i) {
      const double sum = x + part_[i], other = sum - x;
      const double rest = (x - (sum - other)) + (part_[i] - other);
      x = sum;
      if (rest != 0) part_[size++] = rest;
    }
    if (x != 0) part_[size++] = x;
    size_ = size;
  }
  RAYSHEAF_HD void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  /// -1, 0 or 1.
  [[nodiscard]] RAYSHEAF_HD int sign() const {
    return size_ == 0 ? 0 : part_[size_ - 1] > 0 ? 1 : -1;
  }

 private:
  double part_[64];  ///< of growing size, none overlapping the next; no sum here has more
  int size_ = 0;
};

}  // namespace raysheaf
