// Maps values to positions in a plot.
#pragma once

#include <cmath>

namespace raysheaf::app {

/// A logarithmic axis from pixel `from` to pixel `to`.
struct Axis {
  double low = 1, high = 10, from = 0, to = 1;
  [[nodiscard]] double at(double value) const {
    return from + (to - from) * std::log(value / low) / std::log(high / low);
  }
};

}  // namespace raysheaf::app
