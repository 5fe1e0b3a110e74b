// `raysheaf bench gpu` on the command line.
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

CLI::App* add_bench_gpu(CLI::App& bench, BenchGpuCommand& command);

}  // namespace raysheaf::app
