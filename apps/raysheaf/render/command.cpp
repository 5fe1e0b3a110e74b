#include <fmt/format.h>
#include <algorithm>
#include <memory>
#include <optional>

#include "apps/support/console.h"
#include "apps/support/output_files.h"
#include "apps/support/progress_bar.h"
#include "apps/support/scene_argument.h"
#include "apps/support/table.h"
#include "apps/support/timer.h"
#include "apps/support/values.h"
#include "options.h"
#include "ranks/ranks.h"
#include "raysheaf/cameras.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "render/default_output.h"
#include "render/files.h"
#include "render/film.h"
#include "render/frames_command.h"
#include "render/light.h"
#include "render/picture.h"
#include "render/stage.h"
#include "render/stream.h"
#include "render/viewpoint.h"
#include "scene_input.h"
#include "system/terminal.h"

namespace raysheaf::app {
namespace {

/// The files to write; an empty path is not requested.
struct Targets {
  std::vector<std::string> pictures;
  std::string stats, heatmap;
  OutputFiles files;
};

Targets open_targets(const RenderCommand& command) {
  Targets targets{{}, {}, {}, output_files(command)};
  OutputFiles& files = targets.files;
  for (const std::string& path : command.pictures)
    targets.pictures.push_back(path == kStandardOutput ? path : files.open(path));
  targets.stats =
      command.stats_path == kStandardOutput ? command.stats_path : files.open(command.stats_path);
  targets.heatmap = files.open(command.heatmap_path);
  if (command.frames.resume && is_streamed(command)) files.claim(checkpoint_path(command, nullptr));
  return targets;
}

bool wants_pixel_tests(const RenderCommand& command) {
  if (!command.heatmap_path.empty()) return true;
  for (const std::string& path : command.pictures) {
    if (has_ending(path, ".exr")) return true;
  }
  return false;
}

/// Calls `render_it(options)` with a progress bar.
template <class Render>
Staged with_progress(const RenderCommand& command, std::optional<Backdrop>* backdrop,
                     const Render& render_it) {
  ProgressBar bar(stderr, !command.quiet && !is_silent());
  RenderOptions options = command.options;
  options.count_pixel_tests = wants_pixel_tests(command);
  if (command.background) backdrop->emplace(*command.background).watch(&options);
  options.progress = [&bar](const Progress& progress) {
    bar.update(progress.stage, progress.done, progress.total);
    return !interrupted();
  };
  return render_it(options);
}

/// A frame, and how it came about.
struct Rendered {
  Staged staged;
  std::optional<Backdrop> backdrop;
  double load_ms = 0;
  std::size_t meshes = 0, instances = 0;  ///< of the scene, as `info` counts them
  SharedBy ranks;
};

void write_outputs(const RenderCommand& command, const Targets& targets, const Rendered& rendered) {
  const RenderResult& result = rendered.staged.picture;
  for (std::size_t i = 0; i < targets.pictures.size(); ++i) {
    stop_if_interrupted();
    write_picture(result, command.pictures[i], targets.pictures[i], rendered.backdrop);
  }
  stop_if_interrupted();
  if (!targets.heatmap.empty()) write_png(heatmap(result), targets.heatmap);
  if (targets.stats.empty()) return;
  std::string json = to_json(result.statistics, rendered.load_ms);
  if (rendered.staged.stream) json = with_stream(std::move(json), *rendered.staged.stream);
  if (rendered.ranks.count > 1) json = with_ranks(std::move(json), rendered.ranks);
  if (targets.stats == kStandardOutput) return print(json);
  write_text(json, targets.stats);
}

/// "1 234 567 rays in 0.5 s, 2.5 M rays/s".
std::string speed_text(const FrameStatistics& statistics) {
  std::uint64_t rays = 0;
  for (const BatchStatistics& batch : statistics.batches) rays += batch.rays;
  const double seconds = statistics.total_ms * 1e-3;
  std::string text = fmt::format("{} in {:.3g} s", count_text(rays, "ray", "rays"), seconds);
  if (rays > 0 && seconds > 0)
    text += fmt::format(", {} rays/s", short_number(static_cast<double>(rays) / seconds));
  return text;
}

void tell_summary(const RenderCommand& command, const Rendered& rendered) {
  const FrameStatistics& statistics = rendered.staged.picture.statistics;
  tell(fmt::format("{}: {}, {}, {}; loaded in {:.3g} s", printable(statistics.scene),
                   count_text(statistics.triangles, "triangle", "triangles"),
                   count_text(rendered.meshes, "mesh", "meshes"),
                   count_text(rendered.instances, "instance", "instances"),
                   rendered.load_ms * 1e-3));
  tell(fmt::format("{}x{}, {}: {} ({}, {})", statistics.width, statistics.height,
                   count_text(statistics.samples.size(), "sample per pixel", "samples per pixel"),
                   speed_text(statistics), statistics.method,
                   count_text(statistics.threads, "thread", "threads")));
  if (rendered.staged.stream) tell(stream_text(*rendered.staged.stream));
  if (rendered.ranks.count > 1)
    tell(fmt::format("shared among {} ranks by {}", rendered.ranks.count, rendered.ranks.what));
  const auto wrote = [](const std::string& path, const char* what) {
    if (path == kStandardOutput) return tell(fmt::format("wrote the {} to standard output", what));
    if (!path.empty()) tell("wrote " + printable(path));
  };
  for (const std::string& path : command.pictures) wrote(path, "image");
  wrote(command.heatmap_path, "heat map");
  wrote(command.stats_path, "statistics");
}

/// One batch: its size, the choices for it with their reasons, and their results.
std::string explained(const BatchStatistics& batch, const std::string& method) {
  std::string text = fmt::format("{}, bounce {}: {} {}, {} {}\n", to_string(batch.kind),
                                 batch.bounce, batch.rays, batch.rays == 1 ? "ray" : "rays",
                                 batch.triangles, batch.triangles == 1 ? "triangle" : "triangles");
  if (batch.rays == 0) return text + "  nothing to do\n";
  if (batch.plan.empty()) text += "  no plan: " + method + " treats every batch in the same way\n";
  for (const std::string& sentence : batch.plan) text += "  " + sentence + "\n";
  std::uint64_t level_tests = 0;
  for (const LevelStatistics& level : batch.levels) level_tests += level.tests;
  text += fmt::format(
      "  tests: {} of bundles with bounds, {} of rays with bounds, {} of rays with triangles; "
      "{:.4f} % of brute force's\n",
      level_tests + batch.bound_tests, batch.ray_bound_tests, batch.final_tests,
      batch.relative() * 100);
  const StageTimes& t = batch.times_ms;
  return text + fmt::format("  hits: {} rays; ms: order {:.1f}, hierarchy {:.1f}, trace {:.1f}\n",
                            batch.hits, t.order, t.hierarchy, t.traverse + t.intersect);
}

void explain(const FrameStatistics& statistics) {
  std::string text;
  if (statistics.primary.starts_with("trace: "))
    text += "primary visibility: " + statistics.primary + "\n";
  if (statistics.primary.starts_with("raster into"))
    text += fmt::format("primary visibility: {}; {:.1f} ms\n", statistics.primary,
                        statistics.raster_ms);
  if (statistics.samples.size() > 1)
    text += fmt::format(
        "samples: {} per pixel; each plan is that of the first sample, counts are of all samples\n",
        statistics.samples.size());
  for (const BatchStatistics& batch : statistics.batches)
    text += explained(batch, statistics.method);
  if (statistics.batches.empty()) text += "no rays were traced\n";
  print(text);
}

/// Writes the requested files and messages of a frame.
void finish(const RenderCommand& command, const Targets& targets, const Rendered& rendered) {
  write_outputs(command, targets, rendered);
  if (!command.quiet) tell_summary(command, rendered);
  if (command.explain) explain(rendered.staged.picture.statistics);
}

/// The focus of a pinhole has no effect, unless an aperture is given.
void check_focus(const RenderCommand& command, const SceneDescription& scene) {
  const RenderOptions& options = command.options;
  if (!options.focus || options.aperture) return;
  if (aperture_of(command, scene) > 0) return;
  throw Error(ErrorCode::kInvalidArgument,
              "the camera is a pinhole, without a lens: give --aperture", "--focus");
}

/// Options that have no effect on this scene are errors.
void check_effect_on(const RenderCommand& command, const Animation& animation,
                     const SceneDescription& scene) {
  const FramesOptions& f = command.frames;
  const auto refuse = [](const char* option, const char* why) {
    throw Error(ErrorCode::kInvalidArgument, std::string("has no effect: ") + why, option);
  };
  const bool is_sequence = !animation.frame_times().empty();
  const bool moves = is_sequence || !animation.clips().empty();
  if (f.time && !moves) refuse("--time", "nothing in the scene moves");
  const bool has_rate =
      std::any_of(command.pictures.begin(), command.pictures.end(), is_film_name) ||
      !f.camera_path.empty() || (moves && !is_sequence && f.turntable == 0);
  if (f.fps && !has_rate)
    refuse("--fps", moves ? "the frames do not depend on it" : "nothing in the scene moves");
  if (command.load.preload && !is_sequence)
    refuse("--preload", "the scene is no sequence of files");
  const auto has_place = [](const Light& light) {
    return light.type == Light::Type::kPoint || light.type == Light::Type::kSpot;
  };
  if (command.light.size && std::none_of(scene.lights.begin(), scene.lights.end(), has_place))
    refuse("--light-size", "the scene has no point and no spot lights");
}

/// Opens SCENE with its animation, with the camera, the light and the ground of the command line,
/// at the given time. Afterwards `command` names the camera.
std::unique_ptr<Animation> open_scene(RenderCommand* given, const GeometrySource* blocks) {
  const RenderCommand& command = *given;
  std::unique_ptr<Animation> animation =
      blocks != nullptr ? animate(*blocks)
                        : animation_from_argument(command.scene, command.frames, command.load);
  SceneDescription& scene = animation->scene();
  set_environment(command.light, command.view.viewpoint.up, scene);
  set_camera(given, blocks, *animation);
  if (wants_frames(command) || command.frames.time) {
    add_missing_camera_and_light(*animation);
  } else {
    add_missing_camera_and_light(scene);
  }
  set_light_size(command.light, scene);
  set_look(given, scene);
  check_focus(command, scene);
  check_effect_on(command, *animation, scene);
  if (command.ground) given->options.ground = ground_of(command, *animation);
  if (command.frames.time) static_cast<void>(animation->seek(*command.frames.time));
  return animation;
}

/// Without --size, uses the default size of the camera.
RenderCommand with_size(RenderCommand command, const SceneDescription& scene) {
  RenderOptions& options = command.options;
  if (options.width != 0) return command;
  const bool on_path = !command.frames.camera_path.empty();
  const DefaultSize size = default_size(on_path ? Camera{} : find_camera(scene, options.camera));
  options.width = size.width;
  options.height = size.height;
  return command;
}

void render_picture(const RenderCommand& command, const Targets& targets, const Timer& loading,
                    const GeometrySource* blocks, std::unique_ptr<Animation> animation,
                    const std::shared_ptr<Communicator>& ranks) {
  const bool streams = is_streamed(command);
  std::vector<std::string> files = animation->scene().files;
  files.push_back(command.scene);
  const auto checkpoint = streams ? open_checkpoint(command, ranks.get(), files) : nullptr;
  const auto stage = make_stage(command, ranks, blocks, checkpoint.get());
  stage->show(animation->scene());
  Rendered rendered;
  rendered.meshes = animation->scene().meshes.size();
  rendered.instances = animation->scene().instances.size();
  if (streams) animation.reset();  // the blocks contain its triangles
  rendered.load_ms = loading.ms();
  stop_if_interrupted();
  rendered.staged = with_progress(command, &rendered.backdrop, [&](const RenderOptions& options) {
    return stage->render(options, {});
  });
  if (ranks != nullptr) rendered.ranks = {ranks->size(), streams ? "geometry" : "rays"};
  if (is_first(ranks.get())) finish(command, targets, rendered);
  if (checkpoint == nullptr) return;
  // until here other processes need the parts that each one keeps
  if (ranks != nullptr) ranks->combine({}, 1, nullptr);
  checkpoint->remove();
}

/// The part of the run that every process does.
void render_here(RenderCommand command, const std::shared_ptr<Communicator>& ranks) {
  const bool writes = is_first(ranks.get());
  Targets targets = wants_frames(command) || !writes ? Targets{} : open_targets(command);
  const Timer loading;
  const std::unique_ptr<GeometrySource> blocks = open_blocks(command);
  std::unique_ptr<Animation> animation = open_scene(&command, blocks.get());
  targets.files.reads(animation->scene().files);
  stop_if_interrupted();
  if (!command.quiet) tell_warnings(animation->scene().warnings);
  const RenderCommand sized = with_size(command, animation->scene());
  if (wants_frames(command)) return render_frames(sized, blocks.get(), *animation, ranks);
  render_picture(sized, targets, loading, blocks.get(), std::move(animation), ranks);
}

}  // namespace

int run(const RenderCommand& given) {
  catch_interrupts();
  RenderCommand command = given;
  if (writes_nothing(command)) command.pictures = {default_picture(command.scene)};
  for (const std::string& path : command.pictures) {
    if (path == kStandardOutput && system::is_terminal(stdout))
      throw Error(ErrorCode::kInvalidArgument,
                  "an image cannot be written to a terminal: give a file", "-o");
  }
  const SceneInput input(&command.scene);
  input.naming(
      [&] { run_together(command, [&](const auto& ranks) { render_here(command, ranks); }); });
  return kSuccess;
}

}  // namespace raysheaf::app
