// The median of measurements.
#pragma once

#include <vector>

namespace raysheaf::app {

/// The mean of the two middle values for an even count; 0 without values.
[[nodiscard]] double median(std::vector<double> values);

}  // namespace raysheaf::app
