// The comparison as a page and as text.
#pragma once

#include <string>

#include "compare/compare.h"

namespace raysheaf::app {

/// Markdown; `plot` is a link to the plot, or empty.
[[nodiscard]] std::string compare_page(const CompareReport& report, const std::string& plot);

/// Tables for a terminal.
[[nodiscard]] std::string compare_text(const CompareReport& report);

}  // namespace raysheaf::app
