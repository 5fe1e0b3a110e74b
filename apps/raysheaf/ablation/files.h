// The ablation's figures for other programs (docs/bench.md).
#pragma once

#include <string>

#include "ablation/ablation.h"

namespace raysheaf::app {

[[nodiscard]] std::string ablation_json(const AblationReport& report);
[[nodiscard]] std::string ablation_csv(const AblationReport& report);

}  // namespace raysheaf::app
