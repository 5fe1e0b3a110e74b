// `raysheaf bench scale` on the command line.
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

CLI::App* add_bench_scale(CLI::App& bench, BenchScaleCommand& command);

}  // namespace raysheaf::app
