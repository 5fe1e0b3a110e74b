// `raysheaf bench compare` on the command line.
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

CLI::App* add_bench_compare(CLI::App& bench, BenchCompareCommand& command);

}  // namespace raysheaf::app
