// Which pictures of a scene that moves `render` makes, and where each goes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "raysheaf/animation.h"
#include "raysheaf/cameras.h"

namespace raysheaf::app {

/// The first and the last frame, both included; none: from the start, to the end.
struct FrameRange {
  std::optional<std::uint64_t> first, last;
};

struct FramesOptions {
  std::string sequence;        ///< a pattern of files, besides SCENE
  std::string clip;            ///< by name or by number; empty: the first
  std::optional<double> time;  ///< of a single picture
  std::optional<FrameRange> range;
  double fps = 24;
  std::uint32_t turntable = 0;  ///< pictures around; 0: none
  std::string camera_path;      ///< a file
  bool resume = false;
  Vec3 up{0, 1, 0};  ///< what a turntable turns about
};

/// SCENE as it moves, at rest. Throws as `load_animation` does, and kNotFound for the clip.
[[nodiscard]] std::unique_ptr<Animation> animation_from_argument(const std::string& scene,
                                                                 const FramesOptions& options,
                                                                 const LoadOptions& load);

/// `--sequence`: a pattern without a folder is looked for beside SCENE.
[[nodiscard]] std::string sequence_pattern(const std::string& scene, const std::string& sequence);

/// The frames of a run: which there are, when each is, and who looks.
class FramePlan {
 public:
  /// A turntable goes around `bounds`, from where `camera` stands: by name or index, as
  /// `RenderOptions::camera`. Throws `Error`: kInvalidArgument for a range that names none of the
  /// frames, what `load_camera_path` throws.
  FramePlan(Animation& animation, const Box& bounds, const FramesOptions& options,
            const std::string& camera);

  [[nodiscard]] std::uint64_t first() const { return first_; }
  [[nodiscard]] std::uint64_t last() const { return last_; }
  [[nodiscard]] std::uint64_t count() const { return last_ - first_ + 1; }
  /// Of all frames that there are, whichever are made.
  [[nodiscard]] std::uint64_t total() const { return total_; }
  /// Seconds of the scene's time.
  [[nodiscard]] double time(const Animation& animation, std::uint64_t frame) const;
  /// From where a frame is seen; none: from the scene's own camera.
  [[nodiscard]] std::optional<Camera> camera(std::uint64_t frame) const;

 private:
  double fps_;
  std::uint64_t first_ = 0, last_ = 0, total_ = 0;
  std::uint32_t turntable_ = 0;
  Camera turning_;
  Vec3 center_, up_;
  std::optional<CameraPath> path_;
  std::string path_name_;
};

/// Whether a name has a place for a frame's number: "%d", or "%04d" for leading zeros.
[[nodiscard]] bool has_frame_field(const std::string& name);
/// The name with the number there. Throws `Error` (kInvalidArgument) for any other "%" and for two
/// places.
[[nodiscard]] std::string with_frame(const std::string& name, std::uint64_t frame);

}  // namespace raysheaf::app
