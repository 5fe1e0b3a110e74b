#include "render/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "apps/support/scene_argument.h"
#include "raysheaf/error.h"
#include "raysheaf/renderer.h"

namespace raysheaf::app {
namespace {

std::unique_ptr<Animation> load(const std::string& scene, const FramesOptions& options,
                                const LoadOptions& load) {
  if (!options.sequence.empty()) {
    if (scene.starts_with("builtin:"))
      throw Error(ErrorCode::kInvalidArgument, "needs a scene in a file, not a built-in one",
                  "--sequence");
    SequenceFiles files;
    files.still = scene;
    files.frames = files_like(sequence_pattern(scene, options.sequence));
    return load_sequence(files, load);
  }
  if (scene.starts_with("builtin:")) return animate(scene_from_argument(scene, load));
  return load_animation(scene, load);
}

void choose_clip(Animation& animation, const std::string& wanted) {
  if (wanted.empty()) return;
  const std::vector<std::string>& clips = animation.clips();
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (clips[i] == wanted || std::to_string(i) == wanted)
      return animation.play(static_cast<std::uint32_t>(i));
  }
  std::string names;
  for (std::size_t i = 0; i < clips.size(); ++i)
    names += fmt::format("{}{} \"{}\"", i == 0 ? "" : ", ", i, clips[i]);
  throw Error(ErrorCode::kNotFound,
              fmt::format("the scene has no clip \"{}\"; it has {}", wanted,
                          names.empty() ? "none" : names),
              "--clip");
}

/// A "%", digits and a "d" in a name. Any other "%" is a letter of the name.
struct Field {
  std::size_t begin = 0, end = 0;
};
std::optional<Field> find_field(const std::string& name, std::size_t from) {
  for (std::size_t at = name.find('%', from); at != name.npos; at = name.find('%', at + 1)) {
    const std::size_t letter = name.find_first_not_of("0123456789", at + 1);
    if (letter != name.npos && name[letter] == 'd') return Field{at, letter + 1};
  }
  return std::nullopt;
}

/// The N of "%0Nd", 0 for "%d"; nothing for other fields.
std::optional<int> digits_of(std::string_view field) {
  constexpr int kMostDigits = 20;
  if (field == "%d") return 0;
  const std::string_view number = field.substr(1, field.size() - 2);
  int digits = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), digits);
  const bool is_number = error == std::errc{} && end == number.data() + number.size();
  if (!is_number || number[0] != '0' || digits < 1 || digits > kMostDigits) return std::nullopt;
  return digits;
}

/// More are probably a mistake: an animation that counts milliseconds as seconds.
constexpr std::uint64_t kMostFrames = 250'000;

std::uint64_t total_frames(const Animation& animation, const FramesOptions& options,
                           const std::optional<CameraPath>& path) {
  if (options.turntable != 0) return options.turntable;
  if (!path) return frame_count(animation, options.fps.value_or(kFramesPerSecond));
  return frame_count(path->keys.back().time - path->keys.front().time,
                     options.fps.value_or(kFramesPerSecond));
}

}  // namespace

std::string sequence_pattern(const std::string& scene, const std::string& sequence) {
  const bool beside = sequence.find('/') == std::string::npos;
  return (beside ? scene.substr(0, scene.rfind('/') + 1) : "") + sequence;
}

std::unique_ptr<Animation> animation_from_argument(const std::string& scene,
                                                   const FramesOptions& options,
                                                   const LoadOptions& load_options) {
  std::unique_ptr<Animation> animation = load(scene, options, load_options);
  choose_clip(*animation, options.clip);
  return animation;
}

FramePlan::FramePlan(Animation& animation, const Box& bounds, const FramesOptions& options,
                     const std::string& camera)
    : fps_(options.fps.value_or(kFramesPerSecond)),
      turntable_(options.turntable),
      up_(options.up),
      path_name_(options.camera_path) {
  if (!options.camera_path.empty()) path_ = load_camera_path(options.camera_path);
  if (turntable_ != 0) {
    turning_ = find_camera(animation.scene(), camera);
    center_ = {0.5f * (bounds.min.x + bounds.max.x), 0.5f * (bounds.min.y + bounds.max.y),
               0.5f * (bounds.min.z + bounds.max.z)};
  }
  total_ = total_frames(animation, options, path_);
  const FrameRange range = options.range.value_or(FrameRange{});
  first_ = range.first.value_or(0);
  last_ = range.last.value_or(total_ - 1);
  if (range.first && range.last && first_ > last_) {
    throw Error(
        ErrorCode::kInvalidArgument,
        fmt::format("{}:{} goes backwards: give the first frame before the last", first_, last_),
        "--frames");
  }
  if (first_ > last_ || last_ >= total_) {
    throw Error(ErrorCode::kInvalidArgument,
                total_ == 1 ? "nothing moves: the only frame is 0"
                            : fmt::format("there are {} frames, 0 to {}", total_, total_ - 1),
                "--frames");
  }
  if (count() > kMostFrames) {
    throw Error(ErrorCode::kInvalidArgument,
                fmt::format("there are {} frames, and one run makes at most {}: choose a range",
                            count(), kMostFrames),
                "--frames");
  }
}

double FramePlan::time(const Animation& animation, std::uint64_t frame) const {
  if (path_ && animation.frame_times().empty())
    return path_->keys.front().time + static_cast<double>(frame) / fps_;
  return frame_time(animation, frame, fps_);
}

std::optional<Camera> FramePlan::camera(std::uint64_t frame) const {
  if (path_) {
    try {
      return camera_at(*path_, path_->keys.front().time + static_cast<double>(frame) / fps_);
    } catch (const Error& error) {
      throw Error(error.code(), error.sentence(), path_name_);
    }
  }
  if (turntable_ == 0) return std::nullopt;
  return turned_camera(turning_, center_, static_cast<double>(frame) / turntable_, up_);
}

bool has_frame_field(const std::string& name) {
  return find_field(name, 0).has_value();
}

std::string with_frame(const std::string& name, std::uint64_t frame) {
  const std::optional<Field> field = find_field(name, 0);
  if (!field) return name;
  const std::string_view all = name;
  const std::optional<int> digits = digits_of(all.substr(field->begin, field->end - field->begin));
  if (!digits || find_field(name, field->end)) {
    throw Error(ErrorCode::kInvalidArgument,
                "a name may have one place for the frame's number: %d, or %04d for leading zeros",
                name);
  }
  return fmt::format("{}{:0{}}{}", all.substr(0, field->begin), frame, *digits,
                     all.substr(field->end));
}

}  // namespace raysheaf::app
