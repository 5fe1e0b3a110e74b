// The bundles of a whole frame, as distributions: how large they are, how loose their bounds.
#pragma once

#include <string>
#include <vector>

#include "report/measure.h"

namespace raysheaf::app {

/// Shares of rays on a scale of powers of two.
struct Histogram {
  int first = 0;               ///< bin i holds values from 2^(first + i) to below its double
  std::vector<double> shares;  ///< they sum to 1; the first bin takes all that is smaller, the last
                               ///< all that is larger
  double low = 0, median = 0, high = 0;  ///< a tenth, half, nine tenths of the rays are below
};

/// All bundles of one level of one method, of every batch. A bundle weighs as much as the rays that
/// it stands for: those of its batch, shared out evenly among the batch's samples.
struct BundleLevel {
  Method method = Method::kRah;
  std::uint32_t level = 1;
  bool only_level = false;  ///< the method has no other
  std::size_t samples = 0;
  double mean_rays = 0;  ///< a bundle
  double looseness = 0;  ///< all triangles that bounds met over all that were needed
  Histogram direction_degrees, origin_percent, loose;
};

/// From the top down, methods in the report's order; those without bundles have none.
[[nodiscard]] std::vector<BundleLevel> bundle_levels(const Report& report);

}  // namespace raysheaf::app
