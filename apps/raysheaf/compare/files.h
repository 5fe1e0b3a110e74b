// The comparison as JSON (docs/bench.md).
#pragma once

#include <string>

#include "compare/compare.h"

namespace raysheaf::app {

[[nodiscard]] std::string compare_json(const CompareReport& report);

}  // namespace raysheaf::app
