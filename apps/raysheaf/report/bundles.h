// Distributions over all bundles of a frame: their sizes, and the looseness of their bounds.
#pragma once

#include <string>
#include <vector>

#include "report/measure.h"

namespace raysheaf::app {

/// Shares of rays on a scale of powers of two.
struct Histogram {
  int first = 0;  ///< bin i holds values from 2^(first + i) to below its double
  /// they sum to 1; the first and the last bin include all smaller and larger values
  std::vector<double> shares;
  /// quantiles: a tenth, half and nine tenths of the rays are below
  double low = 0, median = 0, high = 0;
};

/// All bundles of one level of one method, over all batches. The weight of a bundle is the number
/// of rays that it represents: those of its batch, divided evenly among the samples of the batch.
struct BundleLevel {
  Method method = Method::kRah;
  std::uint32_t level = 1;
  bool only_level = false;  ///< the method has no other
  std::size_t samples = 0;
  double mean_rays = 0;  ///< per bundle
  /// all triangles that the bounds intersected, divided by all that were needed
  double looseness = 0;
  Histogram direction_degrees, origin_percent, loose;
};

/// From the top level down, with the methods in the order of the report; methods without bundles
/// have none.
[[nodiscard]] std::vector<BundleLevel> bundle_levels(const Report& report);

}  // namespace raysheaf::app
