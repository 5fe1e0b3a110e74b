// The fields of the page's template. The template (report/page/) defines the appearance; the
// sources next to this file define the content.
#pragma once

#include <kainjow/mustache.hpp>

#include <string>
#include <vector>

#include "report/bundles.h"
#include "report/layers.h"
#include "report/machine.h"

namespace raysheaf::app {

using Fields = kainjow::mustache::data;

inline Fields list_of_fields() {
  return Fields(Fields::type::list);
}

/// Coordinates of drawings, in units of their viewBox.
[[nodiscard]] std::string coordinate(double value);

/// Milliseconds, with as many digits as are significant.
[[nodiscard]] std::string shown_ms(double ms);

/// Plots of tests by method and level, over the whole frame and for each batch, with their tables.
[[nodiscard]] Fields test_plots(const Report& report);

/// Stages of each method, stacked, with its table.
[[nodiscard]] Fields time_plot(const Report& report);

/// Histograms of bundles, three for each level of a method, with their table.
[[nodiscard]] Fields bundle_plots(const std::vector<BundleLevel>& levels);

}  // namespace raysheaf::app
