#include "render/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

/// The length of "%d" or "%0Nd" at `at`, and N; nothing for any other "%".
struct Field {
  std::size_t length = 0;
  int digits = 0;
};
std::optional<Field> field_at(const std::string& name, std::size_t at) {
  std::size_t end = at + 1;
  Field field;
  if (end < name.size() && name[end] == '0') {
    for (++end; end < name.size() && name[end] >= '0' && name[end] <= '9' && field.digits < 100;
         ++end)
      field.digits = 10 * field.digits + (name[end] - '0');
    if (field.digits == 0 || field.digits > 20) return std::nullopt;
  }
  if (end >= name.size() || name[end] != 'd') return std::nullopt;
  field.length = end + 1 - at;
  return field;
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
  return name.find('%') != name.npos;
}

std::string with_frame(const std::string& name, std::uint64_t frame) {
  const std::size_t at = name.find('%');
  if (at == name.npos) return name;
  const std::optional<Field> field = field_at(name, at);
  if (!field || name.find('%', at + 1) != name.npos) {
    throw Error(ErrorCode::kInvalidArgument,
                "a name may have one place for the frame's number: %d, or %04d for leading zeros",
                name);
  }
  return name.substr(0, at) + fmt::format("{:0{}}", frame, field->digits) +
         name.substr(at + field->length);
}

}  // namespace raysheaf::app
