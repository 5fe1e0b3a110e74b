// Animation by a rig, and functions for all animations.
#include "raysheaf/animation.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "animation/look_around.h"
#include "animation/rig_state.h"
#include "raysheaf/cameras.h"
#include "raysheaf/error.h"
#include "raysheaf/stream.h"
#include "raysheaf/studio.h"
#include "scene/subject.h"

namespace raysheaf {
namespace {

/// Whether no two clips drive the same target.
bool go_together(const std::vector<RigClip>& clips) {
  std::set<std::pair<RigPath, std::uint32_t>> driven;
  for (const RigClip& clip : clips) {
    for (const RigChannel& channel : clip.channels)
      if (!driven.insert({channel.path, channel.target}).second) return false;
  }
  return true;
}

/// Joins clips that drive different targets, as in files in which each object was animated
/// separately, into one.
void join(std::vector<RigClip>& clips) {
  if (clips.size() < 2 || !go_together(clips)) return;
  RigClip all = std::move(clips.front());
  for (std::size_t c = 1; c < clips.size(); ++c) {
    all.name += " + " + clips[c].name;
    const auto first = static_cast<std::uint32_t>(all.curves.size());
    for (Curve& curve : clips[c].curves) all.curves.push_back(std::move(curve));
    for (RigChannel channel : clips[c].channels) {
      channel.curve += first;
      all.channels.push_back(channel);
    }
  }
  clips.clear();
  clips.push_back(std::move(all));
}

double end_of(const RigClip& clip) {
  float end = 0;
  for (const RigChannel& channel : clip.channels)
    end = std::max(end, clip.curves[channel.curve].times.back());
  return end;
}

constexpr double kMostFrames = 0xffffffff;

/// A clip of 2 s at 24 frames per second ends with frame 48, although its length is a rounded
/// float.
double frames_in(double seconds, double fps) {
  return 1 + std::floor(seconds * fps + 1e-3);
}

class RigAnimation final : public Animation {
 public:
  RigAnimation(SceneDescription scene, Rig rig, std::uint32_t threads)
      : threads_(threads), scene_(std::move(scene)), rig_(std::move(rig)), state_(rig_) {
    for (const RigClip& clip : rig_.clips) names_.push_back(clip.name);
    state_.write_all(Executor(threads_), scene_);
  }

  SceneDescription& scene() override { return scene_; }
  [[nodiscard]] double start() const override { return 0; }
  [[nodiscard]] double end() const override {
    return rig_.clips.empty() ? 0 : end_of(rig_.clips[clip_]);
  }
  [[nodiscard]] const std::vector<double>& frame_times() const override { return no_times_; }

  SceneChanges seek(double seconds) override {
    fresh_ = fresh_ || state_.has_unmoved_vertices();
    return seek_by(seconds, &RigState::write_moving);
  }
  SceneChanges seek_poses(double seconds) override {
    SceneChanges changes = seek_by(seconds, &RigState::write_poses);
    if (state_.has_unmoved_vertices())
      changes.move_vertices = [this] { state_.move_vertices(Executor(threads_), scene_); };
    return changes;
  }

  [[nodiscard]] const std::vector<std::string>& clips() const override { return names_; }
  void play(std::uint32_t clip) override {
    if (clip >= rig_.clips.size()) {
      throw Error(ErrorCode::kNotFound, "there is no clip " + std::to_string(clip) +
                                            ": the scene has " + std::to_string(rig_.clips.size()));
    }
    clip_ = clip;
    fresh_ = true;
    state_.rest();
  }

 private:
  SceneChanges seek_by(double seconds,
                       SceneChanges (RigState::*write)(const Executor&, SceneDescription&)) {
    if (rig_.clips.empty()) return {};
    const double time = seconds > 0 ? std::min(seconds, end()) : 0;
    if (!fresh_ && time == time_) return {};
    fresh_ = true;  // where it fails, the next call does all of it
    const bool is_told = std::exchange(is_told_, false);
    return within_memory("there is not enough memory", "animation", [&] {
      // Not kept: the least of all executors' threads is what all of them get.
      const Executor executor(threads_);
      state_.apply(executor, rig_.clips[clip_], time);
      SceneChanges changes = (state_.*write)(executor, scene_);
      changes.everything = !is_told;
      time_ = time;
      fresh_ = false;
      is_told_ = true;
      return changes;
    });
  }

  std::uint32_t threads_;
  SceneDescription scene_;
  Rig rig_;
  RigState state_;
  std::vector<std::string> names_;
  std::vector<double> no_times_;
  std::uint32_t clip_ = 0;
  double time_ = 0;
  bool fresh_ = true;    ///< the next call seeks even if the time is the same
  bool is_told_ = true;  ///< false: a call has failed, and its changes have not been returned
};

}  // namespace

double frame_time(const Animation& animation, std::uint64_t frame, double fps) {
  const std::vector<double>& times = animation.frame_times();
  if (times.empty()) return animation.start() + static_cast<double>(frame) / fps;
  return times[std::min<std::uint64_t>(frame, times.size() - 1)];
}

std::uint64_t frame_count(double seconds, double fps) {
  const double frames = frames_in(seconds < 0 ? 0 : seconds, fps);
  if (frames <= kMostFrames) return static_cast<std::uint64_t>(frames);
  throw Error(ErrorCode::kUnsupported, "has more than 2^32 - 1 frames until its end", "animation");
}

std::uint64_t frame_count(const Animation& animation, double fps) {
  const std::vector<double>& times = animation.frame_times();
  if (!times.empty()) return times.size();
  return frame_count(animation.end() - animation.start(), fps);
}

std::vector<std::uint64_t> sample_frames(std::uint64_t count) {
  constexpr std::uint64_t kMost = 5;
  std::vector<std::uint64_t> frames;
  for (std::uint64_t i = 0; i < std::min(count, kMost); ++i)
    frames.push_back(count <= kMost ? i : i * (count - 1) / (kMost - 1));
  return frames;
}

bool look_around_until(Animation& animation, const SeenAtATime& is_enough) {
  constexpr double kRate = 24;
  // A single image of an animation with too many frames to count is rendered nevertheless.
  const auto listed = static_cast<double>(animation.frame_times().size());
  const double frames = listed > 0 ? listed : frames_in(animation.end() - animation.start(), kRate);
  for (const std::uint64_t frame :
       sample_frames(static_cast<std::uint64_t>(std::min(frames, kMostFrames)))) {
    static_cast<void>(animation.seek(frame_time(animation, frame, kRate)));
    if (is_enough(animation.scene())) return true;
  }
  return false;
}

namespace {

/// A scene with a degenerate triangle that spans a box.
SceneDescription scene_of(const Box& box) {
  SceneDescription whole;
  whole.meshes.emplace_back();
  whole.meshes[0].positions = {box.min, box.max};
  whole.meshes[0].triangles = {{0, 0, 1}};
  whole.instances.emplace_back();
  return whole;
}

}  // namespace

Camera framing_camera(Animation& animation, const Viewpoint& viewpoint) {
  ViewFit fit(viewpoint);
  look_around(animation, [&](const SceneDescription& scene) { fit.add(scene); });
  return fit.camera();
}

bool first_camera_shows(Animation& animation) {
  return look_around_until(animation, [](const SceneDescription& scene) {
    return !scene.cameras.empty() && shows(scene.cameras.front(), scene);
  });
}

void add_missing_camera_and_light(Animation& animation) {
  SceneDescription& scene = animation.scene();
  if (!scene.cameras.empty() && !needs_light(scene)) return;
  ViewFit fit{Viewpoint{}};
  look_around(animation, [&](const SceneDescription& shown) { fit.add(shown); });
  if (scene.cameras.empty()) scene.cameras.push_back(fit.camera());
  if (needs_light(scene))
    scene.lights = studio_lights(scene_of(fit.bounds()), scene.cameras.front());
}

std::unique_ptr<Animation> animate(SceneDescription scene, Rig rig, std::uint32_t threads) {
  validate(rig, scene);
  join(rig.clips);
  auto animation = std::make_unique<RigAnimation>(std::move(scene), std::move(rig), threads);
  validate(animation->scene());
  return animation;
}

std::unique_ptr<Animation> animate(SceneDescription scene) {
  validate(scene);
  return std::make_unique<RigAnimation>(std::move(scene), Rig{}, 1);
}

std::unique_ptr<Animation> animate(const GeometrySource& source) {
  validate_but_triangles(source.scene());
  return std::make_unique<RigAnimation>(source.scene(), Rig{}, 1);
}

void pose(const Rig& rig, SceneDescription& scene) {
  validate(rig, scene);
  const Executor executor;
  RigState(rig).write_all(executor, scene);
}

}  // namespace raysheaf
