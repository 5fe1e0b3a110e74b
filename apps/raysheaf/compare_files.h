// The comparison as JSON (docs/command-line.md).
#pragma once

#include <string>

#include "bench_compare.h"

namespace raysheaf::app {

[[nodiscard]] std::string compare_json(const CompareReport& report);

}  // namespace raysheaf::app
