// The commands and the groups of options that parse.cpp puts together. A command must live until
// the command line is parsed.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

#include "options.h"

namespace raysheaf::app {

CLI::App* add_report(CLI::App& app, ReportCommand& command);
CLI::App* add_view_command(CLI::App& app, ViewCommand& command);
CLI::App* add_scene(CLI::App& app, SceneCommand& command);
CLI::App* add_pack(CLI::App& app, PackCommand& command);
CLI::App* add_verify(CLI::App& app, VerifyCommand& command);

// The commands of `raysheaf bench`.
CLI::App* add_bench_ablation(CLI::App& bench, BenchAblationCommand& command);
CLI::App* add_bench_compare(CLI::App& bench, BenchCompareCommand& command);
CLI::App* add_bench_gpu(CLI::App& bench, BenchGpuCommand& command);
CLI::App* add_bench_instances(CLI::App& bench, BenchInstancesCommand& command);
CLI::App* add_bench_plan(CLI::App& bench, BenchPlanCommand& command);
CLI::App* add_bench_scale(CLI::App& bench, BenchScaleCommand& command);
/// The options that choose the cases of `compare` and `plan`.
void add_compared_scenes(CLI::App& app, std::string& folder, std::vector<std::string>& scenes,
                         std::vector<CompareKind>& kinds, std::vector<CompareMode>& modes);

// The options of `render`, by group, and the checks of each. A check throws CLI11's error.

/// -o.
void add_outputs(CLI::App& app, RenderCommand& command);
/// All other files, the background, and what the terminal shows.
void add_other_outputs(CLI::App& app, RenderCommand& command);
void check_outputs(const RenderCommand& command);

/// --view and --up.
void add_common_viewpoint(CLI::App& app, ViewOptions& view);
/// All other options of the viewpoint.
void add_viewpoint(CLI::App& app, ViewOptions& view);
/// Refuses viewpoints that contradict themselves, --camera or --camera-path.
void check_viewpoint(const CLI::App& app, RenderCommand& command);

void add_samples(CLI::App& app, RenderCommand& command);
/// Aperture and focus.
void add_lens(CLI::App& app, RenderCommand& command);
/// Sizes of lights, and the environment.
void add_light(CLI::App& app, RenderCommand& command);

/// Moving scenes.
void add_frames(CLI::App& app, FramesOptions& frames, LoadOptions& load);
/// Refuses options and names of outputs that contradict each other.
void check_frames(const RenderCommand& command);

/// --stream, --memory and --share.
void add_streaming(CLI::App& app, RenderCommand& command);
/// Refuses other options that contradict streaming.
void check_streaming(const CLI::App& app, const RenderCommand& command);

// Options without an effect are errors, so that a typing mistake or a misunderstanding does not
// pass for an answer.

/// Refuses the first option that has no effect together with the others. Options that depend on the
/// scene are checked when it is loaded.
void check_effect(const CLI::App& app, const RenderCommand& command);
/// The same for settings of methods of which none is in `methods`.
void check_method_settings(const CLI::App& app, const std::vector<Method>& methods);

}  // namespace raysheaf::app
