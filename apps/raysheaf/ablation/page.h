// docs/results/ablation.md: every figure in it was measured.
#pragma once

#include <string>

#include "ablation/ablation.h"

namespace raysheaf::app {

/// `plots` leads from the page to the plots (a path as `--svg` takes it); empty: there are none.
[[nodiscard]] std::string ablation_page(const AblationReport& report, const std::string& plots);

/// Which key and bound need the fewest tests and the least time, as text for a terminal.
[[nodiscard]] std::string ablation_text(const AblationReport& report);

}  // namespace raysheaf::app
