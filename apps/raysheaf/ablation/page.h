// docs/results/ablation.md: every figure in it was measured.
#pragma once

#include <string>

#include "ablation/ablation.h"

namespace raysheaf::app {

/// `plots` is the path from the page to the plots, as `--svg` takes it, or empty without plots.
[[nodiscard]] std::string ablation_page(const AblationReport& report, const std::string& plots);

/// The key and bound with the fewest tests and the shortest time, as text for a terminal.
[[nodiscard]] std::string ablation_text(const AblationReport& report);

}  // namespace raysheaf::app
