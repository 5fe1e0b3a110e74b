// CLI11 is seen by the parse files alone.
#include "parse.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <span>

#include "console.h"
#include "parse/ablation.h"
#include "parse/compare.h"
#include "parse/frames.h"
#include "parse/gpu.h"
#include "parse/light.h"
#include "parse/outputs.h"
#include "parse/parts.h"
#include "parse/report.h"
#include "parse/scale.h"
#include "parse/stream.h"
#include "parse/verify.h"
#include "parse/view.h"
#include "parse/viewpoint.h"
#include "raysheaf/error.h"
#include "raysheaf/version.h"
#include "text/describe.h"
#include "values.h"

namespace raysheaf::app {
void add_view(CLI::App& app, RenderOptions& options) {
  add_value(
      app, "--size", "WxH",
      "Size of the picture [512 along the longer side, in the shape of the camera's aspect "
      "ratio; square where it has none]",
      [&options](const auto& text) { std::tie(options.width, options.height) = parse_size(text); });
  app.add_option("--camera", options.camera, "Camera by name or by index from 0 [the first]")
      ->type_name("NAME|INDEX");
  add_value(app, "--exposure", "X", "Factor on radiance before tone mapping [automatic]",
            [&options](const auto& text) { options.exposure = parse_positive(text); });
  add_value(app, "--ambient", "R,G,B|X", "Radiance of a uniform sky [a little, from the lights]",
            [&options](const auto& text) { options.ambient = parse_color(text); });
}

void shape_as_camera(const CLI::App& app, RenderOptions* options) {
  if (app.count("--size") == 0) options->width = options->height = 0;
}

void add_rays(CLI::App& app, RenderOptions& options) {
  add_count(app, "--bounces", options.bounces, 0, 32,
            "Reflections and refractions in a row, 0 to 32 [2]");
  add_off_switch(app, "--no-shadows", options.shadows, "No shadow rays");
  add_off_switch(app, "--no-reflections", options.reflections, "No mirror reflections");
  add_off_switch(app, "--no-refractions", options.refractions, "No refractions");
  app.add_flag(
      "--early-out", options.early_out,
      "Shadow rays stop at their first hit (the paper counts without; dual always does so)");
  add_value(
      app, "--primary", "raster|trace", "First hits by OpenGL (raster) or by rays (trace) [raster]",
      [&options](const std::string& text) {
        if (text != "raster" && text != "trace") {
          throw Error(ErrorCode::kInvalidArgument, "'" + text + "' is neither raster nor trace");
        }
        options.primary = text == "trace" ? Primary::kTrace : Primary::kRaster;
      });
}

void add_settings(CLI::App& app, RenderOptions& options) {
  add_count(app, "--levels", options.levels, 1, 8,
            "Of rah and crsh: levels of the ray hierarchy, 1 to 8 [2]");
  add_count(app, "--branching", options.branching, 2, 64,
            "Of rah and crsh: children of a node, 2 to 64 [8]");
  add_value(app, "--key", "NAME",
            "Of rah, crsh and gl10: what rays are sorted by [the method's own]",
            [&options](const auto& text) { options.key = key_from_string(text); });
  add_value(app, "--key-bits", "32|64", "Of the same: bits of the key, where it comes in both [32]",
            [&options](const auto& text) { options.key_bits = parse_key_bits(text); });
  add_value(app, "--bound", "NAME",
            "Of rah and crsh: what bounds a bundle of rays [the method's own]",
            [&options](const auto& text) { options.bound = bound_from_string(text); });
  add_value(app, "--mesh-culling", "on|off",
            "Of rah and crsh: test the spheres of meshes before their triangles [the method's own]",
            [&options](const auto& text) { options.mesh_culling = parse_switch(text); });
  add_count(app, "--threads", options.threads, 0, 1024, "Threads, up to 1024; 0 is all cores [0]");
}

namespace {

void add_method(CLI::App& app, RenderCommand& command) {
  RenderOptions& options = command.options;
  add_value(app, "--method", "brute|rah|crsh|gl10|dual", "How rays meet triangles [dual]",
            [&options](const auto& text) { options.method = method_from_string(text); });
  add_settings(app, options);
  add_value(app, "--device", "cpu|cuda", "Where the rays are traced [cpu]",
            [&command](const std::string& text) {
              if (text != "cpu" && text != "cuda") {
                throw Error(ErrorCode::kInvalidArgument, "'" + text + "' is neither cpu nor cuda");
              }
              command.device = text == "cuda" ? Device::kCuda : Device::kCpu;
            });
}

CLI::App* add_render(CLI::App& app, RenderCommand& command) {
  CLI::App* sub = app.add_subcommand("render", "Render a scene to pictures and statistics");
  add_scene_file(*sub, command.scene, command.load,
                 {.blocks = true, .sequences = true, .standard_input = true});
  add_outputs(*sub, command);
  add_view(*sub, command.options);
  add_viewpoint(*sub, command.view);
  add_background(*sub, command);
  add_rays(*sub, command.options);
  add_light(*sub, command);
  add_method(*sub, command);
  add_streaming(*sub, command);
  add_frames(*sub, command.frames, command.load);
  sub->footer(
      "Examples:\n"
      "  raysheaf render model.stl --up z\n"
      "  raysheaf render model.ply -o top.jpg --view top --orthographic --background white\n"
      "  raysheaf render builtin:office -o office.png\n"
      "  raysheaf render builtin:cornell -o cornell.png -o cornell.exr --bounces 4\n"
      "  raysheaf render model.glb -o model.png --size 1280x720 --camera 1 --stats model.json\n"
      "  raysheaf render builtin:office -o soft.png --samples 64 --light-size 0.1\n"
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
  });
  return sub;
}

CLI::App* add_info(CLI::App& app, InfoCommand& command) {
  CLI::App* sub = app.add_subcommand("info", "List what a scene holds");
  add_scene_file(*sub, command.scene, command.load, {.blocks = true, .standard_input = true});
  sub->add_flag("--json", command.json, "As JSON");
  sub->footer(
      "Examples:\n"
      "  raysheaf info model.obj\n"
      "  raysheaf info builtin:cornell --json");
  return sub;
}

CLI::App* add_bench_paper(CLI::App& bench, BenchPaperCommand& command) {
  CLI::App* sub = bench.add_subcommand("paper", "Count tests as the paper's tables do");
  sub->add_option("--scenes", command.scenes,
                  "Folder with office.glb, cornell.glb and sponza.glb [the built-in scenes]")
      ->type_name("DIR");
  sub->add_option("--json", command.json_path, "All figures as JSON")->type_name("FILE.json");
  sub->add_option("--markdown", command.markdown_path, "A page with tables and findings")
      ->type_name("FILE.md");
  add_value(
      *sub, "--size", "WxH", "Size of the picture; the paper's is [512x512]",
      [&command](const auto& text) { std::tie(command.width, command.height) = parse_size(text); });
  add_words(*sub, "--method", "A method; may be given more than once [all]", "NAME",
            command.methods, [](const std::string& name) { return method_from_string(name); });
  sub->add_flag("--as-published", command.as_published,
                "Count what the published program tested, with and without each of its quirks");
  sub->add_flag("--check", command.check, "Run brute force too and compare every hit with it");
  add_off_switch(*sub, "--no-times", command.times, "Leave times out of text and Markdown");
  add_count(*sub, "--threads", command.threads, 0, 1024, "Threads, up to 1024; 0 is all cores [0]");
  sub->add_flag("-q,--quiet", command.quiet, "No progress bar");
  sub->footer(
      "Examples:\n"
      "  raysheaf bench paper --size 64x64\n"
      "  raysheaf bench paper --scenes scenes/paper --as-published --markdown reproduction.md");
  return sub;
}

CLI::App* add_bench(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("bench", "Measure: the laboratory's experiments");
  sub->require_subcommand(1);
  sub->footer(
      "Examples:\n"
      "  raysheaf bench paper --size 64x64\n"
      "  raysheaf bench ablation builtin:cornell --size 32x32\n"
      "  raysheaf bench compare --kind mirror\n"
      "\n"
      "raysheaf bench COMMAND --help lists the options of a command.");
  return sub;
}

CLI::App* add_completion(CLI::App& app, CompletionCommand& command) {
  CLI::App* sub = app.add_subcommand("completion", "Print a script that completes command lines");
  sub->add_option("SHELL", command.shell, "bash, zsh or fish")
      ->type_name("bash|zsh|fish")
      ->required();
  sub->footer(
      "Examples:\n"
      "  source <(raysheaf completion bash)\n"
      "  raysheaf completion fish > ~/.config/fish/completions/raysheaf.fish");
  return sub;
}

CLI::App* add_manual(CLI::App& app, ManualCommand& command) {
  CLI::App* sub = app.add_subcommand("manual", "Write manual pages, one a command");
  sub->add_option("-o,--output", command.folder, "Folder to write them to")
      ->type_name("DIR")
      ->required();
  sub->footer(
      "Examples:\n"
      "  raysheaf manual -o man\n"
      "  man man/raysheaf-render.1");
  return sub;
}

// What a variable of the shell should have said must not pass for what was left out.
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

// Whether the words begin with a command of `app`, and so on below it, or with an option; tells
// what there is where they do not.
bool starts_well(std::span<const char* const> words, const CLI::App& app,
                 const std::string& above = "raysheaf") {
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  const std::string first = words.empty() ? "" : words.front();
  if (commands.empty() || first.starts_with("-")) return true;
  std::string names;
  for (const CLI::App* sub : commands) {
    if (sub->get_name() == first)
      return starts_well(words.subspan(1), *sub, above + " " + sub->get_name());
    names += (names.empty() ? "" : ", ") + sub->get_name();
  }
  const std::string what = first.empty() ? "no command" : "'" + first + "' is no command";
  const std::string of = app.get_parent() == nullptr ? "" : " of " + app.get_name();
  tell_error(what + of + "; there are " + names + " (see " + above + " --help)");
  return false;
}

// CLI11 names them backwards.
std::string unexpected(const CLI::App& app) {
  const std::vector<std::string> words = app.remaining(true);
  std::string sentence = words.size() > 1 ? "The following arguments were not expected:"
                                          : "The following argument was not expected:";
  for (const std::string& word : words) sentence += " " + word;
  return sentence;
}

// CLI11's sentence on one line of ours. Its text has no full stop and may have line breaks.
int tell_usage_error(const CLI::ParseError& error, const CLI::App& app) {
  const bool extras = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  std::string sentence = extras ? unexpected(app) : error.what();
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');
  std::string help = "raysheaf";
  for (const CLI::App* sub = &app; !sub->get_subcommands().empty();) {
    sub = sub->get_subcommands().front();
    help += " " + sub->get_name();
  }
  tell_error(sentence + " (see " + help + " --help)");
  return kUsage;
}

}  // namespace

std::variant<Command, int> parse(int argc, const char* const* argv) {
  CLI::App app("Exact ray queries and rendering for triangles that move.", "raysheaf");
  app.set_version_flag("--version", std::string("raysheaf ") + RAYSHEAF_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "  raysheaf render builtin:office -o office.png\n"
      "  raysheaf view model.glb\n"
      "  raysheaf info model.glb\n"
      "  raysheaf scene cornell -o cornell.glb\n"
      "  raysheaf verify\n"
      "\n"
      "raysheaf COMMAND --help lists the options of a command.");
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
  const CLI::App* gpu_app = add_bench_gpu(*bench_app, gpu);
  const CLI::App* scale_app = add_bench_scale(*bench_app, scale);
  const CLI::App* completion_app = add_completion(app, completion);
  const CLI::App* manual_app = add_manual(app, manual);
  refuse_empty_words(app);
  const std::span<const char* const> words(argv, static_cast<std::size_t>(argc));
  if (!starts_well(words.subspan(std::min<std::size_t>(words.size(), 1)), app)) return kUsage;
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    std::ostringstream text;
    app.exit(done, text, text);
    print(text.str());
    return kSuccess;
  } catch (const CLI::ParseError& error) {
    return tell_usage_error(error, app);
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
  if (paper_app->parsed()) return Command(std::move(paper));
  if (ablation_app->parsed()) return Command(std::move(ablation));
  if (compare_app->parsed()) return Command(std::move(compare));
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
