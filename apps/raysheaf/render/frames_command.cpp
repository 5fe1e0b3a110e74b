// `render` for the frames of a moving scene: one renderer makes all of them.
#include <fmt/format.h>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <future>
#include <memory>
#include <numeric>
#include <set>
#include <span>
#include <system_error>

#include "apps/support/console.h"
#include "apps/support/output_files.h"
#include "apps/support/progress_bar.h"
#include "apps/support/table.h"
#include "apps/support/values.h"
#include "ranks/ranks.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "render/files.h"
#include "render/film.h"
#include "render/frames_command.h"
#include "render/picture.h"
#include "render/stage.h"
#include "render/stream.h"

namespace raysheaf::app {
namespace {

class Lap {
 public:
  double ms() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double, std::milli> lap = now - last_;
    last_ = now;
    return lap.count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// All frames need the same memory: each one reuses the memory of the last. Requesting it from the
/// system each time costs a tenth of a frame.
void keep_memory() {
#if defined(__GLIBC__)
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the largest value that it accepts
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

/// The time of a frame in milliseconds. `seek` moves the scene to the frame's time, which reads the
/// file of a sequence.
struct FrameTimes {
  double seek = 0, render = 0, write = 0;
};

/// A frame to be written.
struct Drawn {
  std::uint64_t frame = 0;
  double time = 0;
  FrameTimes times;
  Staged staged;
  std::optional<Backdrop> backdrop;
};

std::string frame_json(const Drawn& drawn) {
  const FrameTimes& times = drawn.times;
  const Staged& staged = drawn.staged;
  std::string picture = to_json(staged.picture.statistics);
  if (staged.stream) picture = with_stream(std::move(picture), *staged.stream);
  return fmt::format(
      "{{\n\"frame\": {},\n\"time\": {},\n\"times_ms\": {{\"seek\": {:.3f}, \"render\": {:.3f}, "
      "\"write\": {:.3f}}},\n{}\"picture\": {}}}\n",
      drawn.frame, drawn.time, times.seek, times.render, times.write,
      staged.update ? fmt::format("\"update\": {},\n", to_json(*staged.update)) : "", picture);
}

/// The box that a turntable moves around.
Box bounds_of(const GeometrySource* blocks, Animation& animation) {
  return blocks != nullptr ? world_bounds(*blocks) : world_bounds(animation.scene());
}

class FrameRun {
 public:
  FrameRun(const RenderCommand& command, const GeometrySource* blocks, Animation& animation,
           const std::shared_ptr<Communicator>& ranks)
      : command_(command),
        frames_(command.frames),
        animation_(animation),
        ranks_(ranks.get()),
        told_warnings_(animation.scene().warnings.size()),
        plan_(animation, bounds_of(blocks, animation), command.frames, command.options.camera),
        options_(command.options),
        missing_(find_missing()),
        frame_each_(takes_a_frame_each()),
        stage_(make_stage(command, frame_each_ ? nullptr : ranks, blocks, nullptr)) {
    options_.count_pixel_tests = !command.heatmap_path.empty();
    for (const std::string& path : command.pictures)
      if (has_ending(path, ".exr")) options_.count_pixel_tests = true;
    options_.progress = [](const Progress&) { return !interrupted(); };
  }

  void run() {
    keep_memory();
    if (is_first(ranks_)) open_targets();
    tell_of_those_that_are_there();
    if (!missing_.empty()) make_frames();
    for (const std::unique_ptr<Film>& film : films_) film->finish();
    if (!command_.quiet) tell_summary();
  }

 private:
  /// As rank 0 finds them, because the others may already be writing.
  [[nodiscard]] std::vector<std::uint64_t> find_missing() const {
    std::vector<std::uint64_t> missing;
    if (is_first(ranks_)) {
      for (std::uint64_t f = plan_.first(); f <= plan_.last(); ++f)
        if (!frames_.resume || !is_there(f)) missing.push_back(f);
    }
    if (ranks_ == nullptr) return missing;
    std::uint64_t count = missing.size();
    ranks_->broadcast(std::as_writable_bytes(std::span(&count, 1)));
    missing.resize(count);
    ranks_->broadcast(std::as_writable_bytes(std::span(missing)));
    return missing;
  }

  /// The frames of a film are needed in order.
  [[nodiscard]] bool takes_a_frame_each() const {
    const bool film = std::any_of(command_.pictures.begin(), command_.pictures.end(),
                                  [](const std::string& path) { return is_film_name(path); });
    return ranks_ != nullptr && !film && command_.share != Share::kRays &&
           command_.share != Share::kGeometry && missing_.size() >= ranks_->size();
  }

  /// Claims the name of every file that will be written. Films have one file for all frames.
  void claim_names() const {
    OutputFiles files = output_files(command_);
    files.reads(animation_.scene().files);
    for (const std::string& path : command_.pictures)
      if (is_film_name(path)) files.claim(with_frame(path, plan_.first()));
    for (const std::uint64_t frame : missing_)
      for (const std::string& path : frame_names(frame)) files.claim(path);
  }

  /// The names of the files of one frame.
  [[nodiscard]] std::vector<std::string> frame_names(std::uint64_t frame) const {
    std::vector<std::string> names;
    for (const std::string& path : command_.pictures)
      if (!is_film_name(path)) names.push_back(with_frame(path, frame));
    for (const std::string& path : {command_.stats_path, command_.heatmap_path})
      if (!path.empty()) names.push_back(with_frame(path, frame));
    return names;
  }

  void open_targets() {
    claim_names();
    for (const std::string& path : command_.pictures) {
      const std::string target = first_target(path);
      if (is_film_name(path)) start_film(path, target);
    }
    for (const std::string& path : {command_.stats_path, command_.heatmap_path})
      if (!path.empty()) static_cast<void>(first_target(path));
  }

  [[nodiscard]] bool is_there(std::uint64_t frame) const {
    const std::vector<std::string> names = frame_names(frame);
    return std::all_of(names.begin(), names.end(), [](const std::string& name) {
      std::error_code failed;
      return std::filesystem::is_regular_file(name, failed);
    });
  }

  /// The file of the first frame, checked for being writable before the work starts.
  [[nodiscard]] std::string first_target(const std::string& path) const {
    return writable_path(with_frame(path, plan_.first()));
  }

  void start_film(const std::string& name, const std::string& target) {
    films_.push_back(make_film(name, target, options_.width, options_.height,
                               frames_.fps.value_or(kFramesPerSecond)));
  }

  void tell_of_those_that_are_there() const {
    const std::uint64_t there = plan_.count() - missing_.size();
    if (command_.quiet || there == 0) return;
    tell(fmt::format("{} of {} frames exist already", there, plan_.count()));
  }

  void make_frames() {
    ProgressBar bar(stderr, !command_.quiet && is_first(ranks_));
    bar.update("frames", 0, missing_.size());
    stage_->show(animation_.scene());
    settle_light();
    frame_ms_.assign(missing_.size(), 0);
    // The frames before `next` are made, or other processes are making them.
    while (const std::optional<std::uint64_t> next = next_frame()) {
      stop_if_interrupted();
      Drawn drawn = make_frame(*next);
      finish_writing();
      tell_new_warnings(&bar);
      bar.update("frames", *next + 1, missing_.size());
      stop_if_interrupted();
      if (frame_each_ || is_first(ranks_)) start_writing(std::make_shared<Drawn>(std::move(drawn)));
    }
    finish_writing();
    if (!frame_each_) return;
    ranks_->combine(std::as_writable_bytes(std::span(frame_ms_)), sizeof(double), take_longer);
    if (!command_.quiet) tell_others_warnings(&bar);
  }

  /// Each process has seen the warnings of its own frames.
  void tell_others_warnings(ProgressBar* bar) {
    const std::vector<std::string>& own = animation_.scene().warnings;
    std::set<std::string> told(own.begin(), own.end());
    for (const std::string& warning : sentences_of_all(*ranks_, own)) {
      if (!told.insert(warning).second) continue;
      bar->wipe();
      tell("warning: " + printable(warning));
    }
  }

  void tell_new_warnings(ProgressBar* bar) {
    const std::vector<std::string>& warnings = animation_.scene().warnings;
    if (command_.quiet || told_warnings_ == warnings.size()) return;
    bar->wipe();
    for (; told_warnings_ < warnings.size(); ++told_warnings_)
      tell("warning: " + printable(warnings[told_warnings_]));
  }

  /// Writes while the next frame is rendered.
  void start_writing(const std::shared_ptr<Drawn>& drawn) {
    const auto work = [this, drawn] { write(*drawn); };
    try {
      writing_ = std::async(std::launch::async, work);
    } catch (const std::system_error&) {
      work();  // no thread is available
    }
  }

  /// Waits for the writing of the previous frame.
  void finish_writing() {
    if (writing_.valid()) writing_.get();
  }

  /// The index in `missing_` of the next frame.
  std::optional<std::uint64_t> next_frame() {
    if (frame_each_) return ranks_->take(missing_.size());
    return made_ < missing_.size() ? std::optional(made_++) : std::nullopt;
  }

  static void take_longer(const std::byte* from, std::byte* into, std::size_t count) {
    for (std::size_t at = 0; at < count * sizeof(double); at += sizeof(double)) {
      double theirs = 0, ours = 0;
      std::memcpy(&theirs, from + at, sizeof(double));
      std::memcpy(&ours, into + at, sizeof(double));
      if (theirs > ours) std::memcpy(into + at, &theirs, sizeof(double));
    }
  }

  /// Finds automatic values once, as the median over small images of a few of all frames. Therefore
  /// they do not flicker, and do not depend on the frames that a run makes.
  void settle_light() {
    if (options_.exposure && options_.ambient) return;
    if (frame_each_ && !is_first(ranks_)) {
      options_.exposure.emplace();
      options_.ambient.emplace();
    } else {
      find_light();
    }
    if (!frame_each_) return;
    ranks_->broadcast(std::as_writable_bytes(std::span(&*options_.exposure, 1)));
    ranks_->broadcast(std::as_writable_bytes(std::span(&*options_.ambient, 1)));
  }

  void find_light() {
    RenderOptions small = options_;
    small.width = std::max(1u, options_.width / 4);
    small.height = std::max(1u, options_.height / 4);
    small.count_pixel_tests = false;
    std::vector<RenderResult> pictures;
    for (const std::uint64_t frame : sample_frames(plan_.total()))
      pictures.push_back(draw(frame, small).picture);
    const auto middle = pictures.begin() + static_cast<std::ptrdiff_t>(pictures.size() / 2);
    std::nth_element(
        pictures.begin(), middle, pictures.end(),
        [](const RenderResult& a, const RenderResult& b) { return a.ambient.x < b.ambient.x; });
    if (!options_.ambient) options_.ambient = middle->ambient;
    std::nth_element(
        pictures.begin(), middle, pictures.end(),
        [](const RenderResult& a, const RenderResult& b) { return a.exposure < b.exposure; });
    if (!options_.exposure) options_.exposure = middle->exposure;
  }

  Staged draw(std::uint64_t frame, const RenderOptions& options) {
    Lap lap;
    stage_->show(animation_.scene(), seek_for(command_, animation_, plan_.time(animation_, frame)));
    times_.seek = lap.ms();
    Staged staged = stage_->render(options, plan_.camera(frame));
    times_.render = lap.ms();
    return staged;
  }

  Drawn make_frame(std::uint64_t place) {
    Drawn drawn;
    drawn.frame = missing_[place];
    RenderOptions options = options_;
    if (command_.background) drawn.backdrop.emplace(*command_.background).watch(&options);
    drawn.staged = draw(drawn.frame, options);
    drawn.time = plan_.time(animation_, drawn.frame);
    drawn.times = times_;
    frame_ms_[place] = times_.seek + times_.render;
    return drawn;
  }

  /// Writes all files of a frame, its statistics last.
  void write(Drawn& drawn) const {
    Lap lap;
    write_pictures(drawn);
    drawn.times.write = lap.ms();
    if (command_.stats_path.empty()) return;
    write_text(frame_json(drawn), writable_path(with_frame(command_.stats_path, drawn.frame)));
  }

  void write_pictures(const Drawn& drawn) const {
    const RenderResult& picture = drawn.staged.picture;
    if (!films_.empty()) {
      const Image image = shown_picture(picture, drawn.backdrop);
      for (const std::unique_ptr<Film>& film : films_) film->add(image);
    }
    for (const std::string& path : command_.pictures) {
      if (is_film_name(path)) continue;
      const std::string name = with_frame(path, drawn.frame);
      write_picture(picture, name, writable_path(name), drawn.backdrop);
    }
    if (!command_.heatmap_path.empty())
      write_png(heatmap(picture), writable_path(with_frame(command_.heatmap_path, drawn.frame)));
  }

  void tell_summary() {
    if (!frame_ms_.empty()) {
      const double mean = std::accumulate(frame_ms_.begin(), frame_ms_.end(), 0.0) /
                          static_cast<double>(frame_ms_.size());
      const auto middle = frame_ms_.begin() + static_cast<std::ptrdiff_t>(frame_ms_.size() / 2);
      std::nth_element(frame_ms_.begin(), middle, frame_ms_.end());
      tell(fmt::format("{}, {}x{}, {}: {:.0f} ms per frame (median), {:.0f} ms on average",
                       count_text(frame_ms_.size(), "frame", "frames"), options_.width,
                       options_.height, to_string(options_.method), *middle, mean));
    }
    if (ranks_ != nullptr)
      tell(fmt::format("shared among {} ranks by {}", ranks_->size(),
                       frame_each_             ? "frames"
                       : is_streamed(command_) ? "geometry"
                                               : "rays"));
    if (missing_.empty()) return tell("nothing is left to render");
    for (const std::string& path : command_.pictures) tell("wrote " + printable(path));
    if (!command_.heatmap_path.empty()) tell("wrote " + printable(command_.heatmap_path));
    if (!command_.stats_path.empty()) tell("wrote " + printable(command_.stats_path));
  }

  const RenderCommand& command_;
  const FramesOptions& frames_;
  Animation& animation_;
  Communicator* ranks_;
  std::size_t told_warnings_;  ///< of the scene: a sequence adds more while it is played
  FramePlan plan_;
  RenderOptions options_;
  std::vector<std::uint64_t> missing_;
  bool frame_each_;  ///< each process makes whole frames by itself
  std::unique_ptr<Stage> stage_;
  std::vector<std::unique_ptr<Film>> films_;
  std::uint64_t made_ = 0;
  FrameTimes times_;
  std::vector<double> frame_ms_;
  std::future<void> writing_;  ///< last member: it uses the others, and its destructor waits
};

}  // namespace

bool wants_frames(const RenderCommand& command) {
  const FramesOptions& f = command.frames;
  if (f.range || f.turntable != 0 || !f.camera_path.empty()) return true;
  for (const std::string& path : command.pictures)
    if (has_frame_field(path) || is_film_name(path)) return true;
  return has_frame_field(command.stats_path) || has_frame_field(command.heatmap_path);
}

void render_frames(const RenderCommand& command, const GeometrySource* blocks, Animation& animation,
                   const std::shared_ptr<Communicator>& ranks) {
  FrameRun(command, blocks, animation, ranks).run();
}

}  // namespace raysheaf::app
