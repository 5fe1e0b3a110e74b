// A bench's figures as JSON (docs/bench.md).
#pragma once

#include <string>

#include "paper/paper.h"

namespace raysheaf::app {

[[nodiscard]] std::string paper_json(const PaperReport& report);

}  // namespace raysheaf::app
