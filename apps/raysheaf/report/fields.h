// What the page's template is filled with. The template (report/page/) says how things look; the
// sources beside this file say what is there and where.
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

/// Milliseconds, with as many digits as mean something.
[[nodiscard]] std::string shown_ms(double ms);

/// Plots of tests by method and level, over the whole frame and for each batch, with their tables.
[[nodiscard]] Fields test_plots(const Report& report);

/// Stages of each method, stacked, with its table.
[[nodiscard]] Fields time_plot(const Report& report);

/// Histograms of bundles, three a level of a method, with their table.
[[nodiscard]] Fields bundle_plots(const std::vector<BundleLevel>& levels);

}  // namespace raysheaf::app
