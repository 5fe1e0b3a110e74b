// The frames of a moving scene that `render` makes, and their files.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "raysheaf/animation.h"
#include "raysheaf/cameras.h"

namespace raysheaf::app {

/// The first and the last frame, both included; an empty one stands for the start or the end.
struct FrameRange {
  std::optional<std::uint64_t> first, last;
};

inline constexpr double kFramesPerSecond = 24;

struct FramesOptions {
  std::string sequence;        ///< a pattern of files, in addition to SCENE
  std::string clip;            ///< by name or by number; empty: the first
  std::optional<double> time;  ///< of a single image
  std::optional<FrameRange> range;
  std::optional<double> fps;    ///< none: `kFramesPerSecond`
  std::uint32_t turntable = 0;  ///< images around the scene; 0: no turntable
  std::string camera_path;      ///< a file
  bool resume = false;
  Vec3 up{0, 1, 0};  ///< the axis of a turntable
};

/// SCENE with its animation, at rest. Throws as `load_animation` does, and kNotFound for the clip.
[[nodiscard]] std::unique_ptr<Animation> animation_from_argument(const std::string& scene,
                                                                 const FramesOptions& options,
                                                                 const LoadOptions& load);

/// `--sequence`: a pattern without a folder is searched next to SCENE.
[[nodiscard]] std::string sequence_pattern(const std::string& scene, const std::string& sequence);

/// The frames of a run: their numbers, their times, and their cameras.
class FramePlan {
 public:
  /// A turntable moves around `bounds`, from the position of `camera`, which is a name or an index
  /// as in `RenderOptions::camera`. Throws `Error`: kInvalidArgument for a range that contains none
  /// of the frames, and the errors of `load_camera_path`.
  FramePlan(Animation& animation, const Box& bounds, const FramesOptions& options,
            const std::string& camera);

  [[nodiscard]] std::uint64_t first() const { return first_; }
  [[nodiscard]] std::uint64_t last() const { return last_; }
  [[nodiscard]] std::uint64_t count() const { return last_ - first_ + 1; }
  /// The number of all frames, whichever are made.
  [[nodiscard]] std::uint64_t total() const { return total_; }
  /// The time of a frame in the scene, in seconds.
  [[nodiscard]] double time(const Animation& animation, std::uint64_t frame) const;
  /// The camera of a frame; empty: the scene's own camera.
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

/// Whether a name has a place for a frame's number: "%d", or "%04d" for leading zeros. A "%" that
/// is not followed by digits and a "d" is a letter of the name.
[[nodiscard]] bool has_frame_field(const std::string& name);
/// The name with the number inserted. Throws `Error` (kInvalidArgument) for a second place, and for
/// other digits than those of a leading zero and a width of up to 20.
[[nodiscard]] std::string with_frame(const std::string& name, std::uint64_t frame);

}  // namespace raysheaf::app
