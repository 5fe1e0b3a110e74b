// The options of `raysheaf bench ablation`.
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

CLI::App* add_bench_ablation(CLI::App& bench, BenchAblationCommand& command);

}  // namespace raysheaf::app
