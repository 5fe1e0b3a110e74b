// The middle of what was measured.
#pragma once

#include <vector>

namespace raysheaf::app {

/// Of an even number the mean of the two in the middle; 0 of none.
[[nodiscard]] double median(std::vector<double> values);

}  // namespace raysheaf::app
