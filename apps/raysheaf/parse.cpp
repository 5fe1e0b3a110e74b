// Only this file, those of parse/ and text/describe.cpp include CLI11.
#include "parse.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <span>

#include "apps/support/console.h"
#include "apps/support/values.h"
#include "parse/commands.h"
#include "parse/parts.h"
#include "parse/usage.h"
#include "raysheaf/error.h"
#include "raysheaf/version.h"
#include "text/describe.h"

namespace raysheaf::app {
void add_size(CLI::App& app, RenderOptions& options) {
  begin_group(app, kCommonGroup);
  add_value(
      app, "--size", "WxH",
      "Size of the image in pixels [512 along the longer side, with the aspect ratio of the "
      "camera; square if it has none]",
      [&options](const auto& text) { std::tie(options.width, options.height) = parse_size(text); });
}

void add_exposure(CLI::App& app, RenderOptions& options) {
  begin_group(app, kOutputGroup);
  add_value(app, "--exposure", "X", "Factor on radiance before tone mapping [automatic]",
            [&options](const auto& text) { options.exposure = parse_positive(text); });
}

void add_camera(CLI::App& app, RenderOptions& options) {
  begin_group(app, kCameraGroup);
  app.add_option(
         "--camera", options.camera,
         "Camera of the scene, by name or by index from 0 [the first, if it shows the scene]")
      ->type_name("NAME|INDEX");
}

void shape_as_camera(const CLI::App& app, RenderOptions* options) {
  if (app.count("--size") == 0) options->width = options->height = 0;
}

void add_rays(CLI::App& app, RenderOptions& options) {
  begin_group(app, kLightGroup);
  add_value(app, "--ambient", "R,G,B|X",
            "Radiance of a uniform sky; without the soft boxes of the studio [a small part of the "
            "lights' radiance]",
            [&options](const auto& text) {
              options.ambient = parse_color(text);
              options.soft_boxes = false;
            });
  add_count(app, "--bounces", options.bounces, 0, 32,
            "Longest chain of reflections and refractions, 0 to 32 [2]");
  add_off_switch(app, "--no-shadows", options.shadows, "Trace no shadow rays");
  add_off_switch(app, "--no-reflections", options.reflections, "Trace no mirror reflections");
  add_off_switch(app, "--no-refractions", options.refractions, "Trace no refractions");
}

namespace {

void add_gbuffer(CLI::App& app, RenderOptions& options) {
  app.add_flag("--gbuffer", options.gbuffer,
               "OpenGL draws the paper's four targets (RGBA32F) instead of triangles' numbers; an "
               "OpenEXR picture shows them");
}

}  // namespace

void add_settings(CLI::App& app, RenderOptions& options) {
  add_value(app, "--primary", "raster|trace",
            "Find the surfaces that the camera sees by OpenGL (raster) or by rays (trace) [raster]",
            [&options](const std::string& text) {
              if (text != "raster" && text != "trace") {
                throw Error(ErrorCode::kInvalidArgument,
                            "'" + text + "' is neither raster nor trace");
              }
              options.primary = text == "trace" ? Primary::kTrace : Primary::kRaster;
            });
  app.add_flag(
      "--early-out", options.early_out,
      "Stop a shadow ray at its first hit, as dual always does (the paper counts without)");
  add_count(app, "--levels", options.levels, 1, 8,
            "Levels of the ray hierarchy of rah and crsh, 1 to 8 [2]");
  add_count(app, "--branching", options.branching, 2, 64,
            "Children of a node of the ray hierarchy of rah and crsh, 2 to 64 [8]");
  add_value(app, "--key", "NAME", "Key by which rah, crsh and gl10 sort rays [the method's own]",
            [&options](const auto& text) { options.key = key_from_string(text); });
  add_value(app, "--key-bits", "32|64", "Bits of that key, if it exists in both widths [32]",
            [&options](const auto& text) { options.key_bits = parse_key_bits(text); });
  add_value(app, "--bound", "NAME",
            "Bounding volume for bundles of rays in rah and crsh [the method's own]",
            [&options](const auto& text) { options.bound = bound_from_string(text); });
  add_value(app, "--mesh-culling", "on|off",
            "Test bounding spheres of meshes before their triangles in rah and crsh [the method's "
            "own]",
            [&options](const auto& text) { options.mesh_culling = parse_switch(text); });
  add_threads(app, options.threads);
}

namespace {

void add_method(CLI::App& app, RenderCommand& command) {
  RenderOptions& options = command.options;
  begin_group(app, kMethodGroup);
  add_value(app, "--method", "brute|rah|crsh|gl10|dual",
            "How intersections of rays and triangles are found [dual]",
            [&options](const auto& text) { options.method = method_from_string(text); });
  add_value(app, "--device", "cpu|cuda", "Where the rays are traced [cpu]",
            [&command](const std::string& text) {
              if (text != "cpu" && text != "cuda") {
                throw Error(ErrorCode::kInvalidArgument, "'" + text + "' is neither cpu nor cuda");
              }
              command.device = text == "cuda" ? Device::kCuda : Device::kCpu;
            });
  add_settings(app, options);
}

CLI::App* add_render(CLI::App& app, RenderCommand& command) {
  CLI::App* sub = app.add_subcommand("render", "Render a scene to images and statistics");
  use_groups(*sub);
  add_scene_file(*sub, command.scene, command.load,
                 {.blocks = true, .sequences = true, .standard_input = true});
  add_outputs(*sub, command);
  add_size(*sub, command.options);
  add_common_viewpoint(*sub, command.view);
  add_samples(*sub, command);
  add_other_outputs(*sub, command);
  add_exposure(*sub, command.options);
  add_camera(*sub, command.options);
  add_viewpoint(*sub, command.view);
  add_lens(*sub, command);
  add_rays(*sub, command.options);
  add_gbuffer(*sub, command.options);
  add_light(*sub, command);
  add_method(*sub, command);
  add_frames(*sub, command.frames, command.load);
  add_streaming(*sub, command);
  sub->footer(
      "Examples:\n"
      "  raysheaf render model.stl --up z\n"
      "  raysheaf render model.ply -o top.jpg --view top --background white\n"
      "  raysheaf render builtin:office -o office.png\n"
      "  raysheaf render builtin:cornell -o cornell.png -o cornell.exr --bounces 4\n"
      "  raysheaf render model.glb --size 1280x720 --camera 1 --stats model.json\n"
      "  raysheaf render builtin:office --samples 64 --light-size 0.1\n"
      "  raysheaf render builtin:atrium --heatmap tests.png --method rah\n"
      "  raysheaf render walk.glb -o frame_%04d.png --fps 24\n"
      "  raysheaf render builtin:office --turntable 90 -o turn.mp4\n"
      "  raysheaf render builtin:atrium --explain --quiet");
  sub->callback([sub, &command] {
    shape_as_camera(*sub, &command.options);
    check_outputs(command);
    check_frames(command);
    check_streaming(*sub, command);
    check_viewpoint(*sub, command);
    check_effect(*sub, command);
  });
  return sub;
}

CLI::App* add_info(CLI::App& app, InfoCommand& command) {
  CLI::App* sub = app.add_subcommand("info", "Summarize what a scene contains");
  add_scene_file(*sub, command.scene, command.load, {.blocks = true, .standard_input = true});
  sub->add_flag("--all", command.all,
                "Also list every mesh, material, light, camera, animation and image");
  sub->add_flag("--json", command.json, "Print everything as JSON");
  sub->callback([sub, &command] {
    if (command.json) refuse_without_effect(*sub, "--all", "--json prints everything");
  });
  sub->footer(
      "Examples:\n"
      "  raysheaf info model.obj\n"
      "  raysheaf info model.glb --all\n"
      "  raysheaf info builtin:cornell --json");
  return sub;
}

CLI::App* add_bench_paper(CLI::App& bench, BenchPaperCommand& command) {
  CLI::App* sub = bench.add_subcommand("paper", "Count tests as the paper's tables do");
  use_groups(*sub);
  begin_group(*sub, kCasesGroup);
  sub->add_option("--scenes", command.scenes,
                  "Folder with office.glb, cornell.glb and sponza.glb [the built-in scenes]")
      ->type_name("DIR");
  add_words(*sub, "--method", "A method; may be given more than once [all]", "NAME",
            command.methods, [](const std::string& name) { return method_from_string(name); });
  add_value(
      *sub, "--size", "WxH", "Size of the image; the paper used [512x512]",
      [&command](const auto& text) { std::tie(command.width, command.height) = parse_size(text); });
  begin_group(*sub, kMeasurementGroup);
  sub->add_flag("--as-published", command.as_published,
                "Count the tests of the published program, with and without each of its quirks");
  sub->add_flag("--check", command.check, "Also run brute force and compare every hit with it");
  add_threads(*sub, command.threads);
  begin_group(*sub, kOutputGroup);
  add_data_file(*sub, "--json", "FILE.json", "Write all figures as JSON", command.json_path);
  add_quiet(*sub, command.quiet);
  sub->footer(
      "Examples:\n"
      "  raysheaf bench paper --size 64x64\n"
      "  raysheaf bench paper --scenes DIR --as-published --json paper.json");
  return sub;
}

CLI::App* add_bench(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("bench", "Measure speed and count intersection tests");
  sub->require_subcommand(1);
  sub->footer(
      "Examples:\n"
      "  raysheaf bench paper --size 64x64\n"
      "  raysheaf bench ablation builtin:cornell --size 32x32\n"
      "  raysheaf bench compare --kind mirror\n"
      "\n"
      "'raysheaf help bench COMMAND' lists the options of a command.");
  return sub;
}

CLI::App* add_completion(CLI::App& app, CompletionCommand& command) {
  CLI::App* sub = app.add_subcommand("completion", "Print a completion script for a shell");
  sub->add_option("SHELL", command.shell, "The shell: bash, zsh or fish")
      ->type_name("bash|zsh|fish")
      ->required();
  sub->footer(
      "Examples:\n"
      "  source <(raysheaf completion bash)\n"
      "  raysheaf completion fish > ~/.config/fish/completions/raysheaf.fish");
  return sub;
}

CLI::App* add_manual(CLI::App& app, ManualCommand& command) {
  CLI::App* sub = app.add_subcommand("manual", "Write a manual page for each command");
  sub->add_option("-o,--output", command.folder, "Folder for the pages")
      ->type_name("DIR")
      ->required();
  sub->footer(
      "Examples:\n"
      "  raysheaf manual -o man\n"
      "  man man/raysheaf-render.1");
  return sub;
}

// An empty word is probably an unset variable of the shell: it must not count as an option that was
// not given.
void refuse_empty_words(const CLI::App& app) {
  const auto check = [](const std::string& word) {
    return std::string(word.empty() ? "it is empty" : "");
  };
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    for (CLI::Option* option : const_cast<CLI::App*>(sub)->get_options())
      if (option->get_items_expected_max() > 0) option->check(check);
    refuse_empty_words(*sub);
  }
}

/// "raysheaf bench paper --size 64x64": the command with what was given to it, except outputs.
/// Where a value is a folder or contains a slash, its type stands for it.
std::string words_of(const CLI::App& bench) {
  std::string words = "raysheaf bench " + bench.get_name();
  for (const CLI::Option* option : bench.get_options()) {
    if (option->count() == 0 || option->get_group() == kOutputGroup) continue;
    const bool named = !option->get_positional();
    const std::string name = named ? " --" + option->get_lnames().front() : "";
    const std::string type = named ? option->get_type_name() : option->get_name(true);
    if (option->get_items_expected_max() == 0) {
      words += name;
      continue;
    }
    for (const std::string& value : option->results()) {
      const bool is_place = type == "DIR" || value.find('/') != std::string::npos;
      const char* const quote = !is_place && value.find(' ') != std::string::npos ? "'" : "";
      words.append(name).append(" ").append(quote).append(is_place ? type : value).append(quote);
    }
  }
  return words;
}

}  // namespace

std::variant<Command, int> parse(int argc, const char* const* argv) {
  CLI::App app("Exact ray queries and rendering for triangles that move.", "raysheaf");
  format_help(app);
  app.set_version_flag("-V,--version", std::string("raysheaf ") + RAYSHEAF_VERSION,
                       "Print the version and exit");
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "  raysheaf render builtin:office -o office.png\n"
      "  raysheaf view model.glb\n"
      "  raysheaf info model.glb\n"
      "  raysheaf scene cornell -o cornell.glb\n"
      "  raysheaf verify\n"
      "\n"
      "'raysheaf help COMMAND' lists the options of a command.");
  RenderCommand render;
  ReportCommand report;
  ViewCommand view;
  InfoCommand info;
  SceneCommand scene;
  PackCommand pack;
  VerifyCommand verify;
  BenchPaperCommand paper;
  BenchAblationCommand ablation;
  BenchCompareCommand compare;
  BenchInstancesCommand instances;
  BenchPlanCommand plan;
  BenchGpuCommand gpu;
  BenchScaleCommand scale;
  CompletionCommand completion;
  ManualCommand manual;
  const CLI::App* render_app = add_render(app, render);
  const CLI::App* report_app = add_report(app, report);
  const CLI::App* view_app = add_view_command(app, view);
  const CLI::App* info_app = add_info(app, info);
  const CLI::App* scene_app = add_scene(app, scene);
  const CLI::App* pack_app = add_pack(app, pack);
  const CLI::App* verify_app = add_verify(app, verify);
  CLI::App* bench_app = add_bench(app);
  const CLI::App* paper_app = add_bench_paper(*bench_app, paper);
  const CLI::App* ablation_app = add_bench_ablation(*bench_app, ablation);
  const CLI::App* compare_app = add_bench_compare(*bench_app, compare);
  const CLI::App* instances_app = add_bench_instances(*bench_app, instances);
  const CLI::App* plan_app = add_bench_plan(*bench_app, plan);
  const CLI::App* gpu_app = add_bench_gpu(*bench_app, gpu);
  const CLI::App* scale_app = add_bench_scale(*bench_app, scale);
  const CLI::App* completion_app = add_completion(app, completion);
  const CLI::App* manual_app = add_manual(app, manual);
  std::vector<std::string> help_words;
  const CLI::App* help_app = add_help(app, help_words);
  refuse_empty_words(app);
  if (argc <= 1) {
    print(help_text(app));
    return kSuccess;
  }
  const std::span<const char* const> words(argv, static_cast<std::size_t>(argc));
  if (!starts_well(words.subspan(1), app)) return kUsage;
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    std::ostringstream text;
    app.exit(done, text, text);
    print(text.str());
    return kSuccess;
  } catch (const CLI::ParseError& error) {
    return report_usage_error(error, app);
  }
  if (help_app->parsed()) {
    const CLI::App* command = find_command(help_words, app);
    if (command == nullptr) return kUsage;
    print(help_text(*command));
    return kSuccess;
  }
  if (render_app->parsed()) return Command(std::move(render));
  if (report_app->parsed()) {
    report.words.assign(argv + 2, argv + argc);
    return Command(std::move(report));
  }
  if (view_app->parsed()) return Command(std::move(view));
  if (info_app->parsed()) return Command(std::move(info));
  if (scene_app->parsed()) return Command(std::move(scene));
  if (pack_app->parsed()) return Command(std::move(pack));
  if (verify_app->parsed()) return Command(std::move(verify));
  paper.words = words_of(*paper_app);
  ablation.words = words_of(*ablation_app);
  compare.words = words_of(*compare_app);
  instances.words = words_of(*instances_app);
  plan.words = words_of(*plan_app);
  scale.words = words_of(*scale_app);
  if (paper_app->parsed()) return Command(std::move(paper));
  if (ablation_app->parsed()) return Command(std::move(ablation));
  if (compare_app->parsed()) return Command(std::move(compare));
  if (instances_app->parsed()) return Command(std::move(instances));
  if (plan_app->parsed()) return Command(std::move(plan));
  if (gpu_app->parsed()) return Command(std::move(gpu));
  if (scale_app->parsed()) return Command(std::move(scale));
  if (completion_app->parsed()) {
    completion.raysheaf = describe(app);
    return Command(std::move(completion));
  }
  if (manual_app->parsed()) manual.raysheaf = describe(app);
  return Command(std::move(manual));
}

}  // namespace raysheaf::app
