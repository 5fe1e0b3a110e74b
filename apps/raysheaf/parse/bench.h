// The options of `raysheaf bench`.
#pragma once

#include "lab/commands/commands.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

/// The options that choose the cases of `compare` and `plan`.
void add_compared_scenes(CLI::App& app, std::string& folder, std::vector<std::string>& scenes,
                         std::vector<CompareKind>& kinds, std::vector<CompareMode>& modes);

CLI::App* add_bench_ablation(CLI::App& bench, BenchAblationCommand& command);
CLI::App* add_bench_compare(CLI::App& bench, BenchCompareCommand& command);
CLI::App* add_bench_gpu(CLI::App& bench, BenchGpuCommand& command);
CLI::App* add_bench_plan(CLI::App& bench, BenchPlanCommand& command);
CLI::App* add_bench_scale(CLI::App& bench, BenchScaleCommand& command);

}  // namespace raysheaf::app
