// docs/results/reproduction.md: every figure in it was measured, except the published ones.
#pragma once

#include <string>

#include "paper/paper.h"

namespace raysheaf::app {

[[nodiscard]] std::string paper_page(const PaperReport& report, bool times);

}  // namespace raysheaf::app
