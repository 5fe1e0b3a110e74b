// Animated scenes that can be brought to any time.
//
//   const std::unique_ptr<raysheaf::Animation> animation = raysheaf::load_animation("walk.glb");
//   raysheaf::Renderer renderer;
//   renderer.show(animation->scene());
//   for (double t = animation->start(); t <= animation->end(); t += 1 / 24.0) {
//     renderer.show(animation->scene(), animation->seek(t));
//     raysheaf::RenderResult image = renderer.render(options);
//   }
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "raysheaf/io.h"
#include "raysheaf/rig.h"
#include "raysheaf/scene_changes.h"

namespace raysheaf {

class GeometrySource;  // raysheaf/stream.h

/// A scene, and how to bring it to a time. Any thread may call it, one at a time.
class Animation {
 public:
  virtual ~Animation() = default;

  /// The scene as the last `seek` left it; before any `seek`, at rest or at the first frame. Its
  /// address never changes. You may edit cameras, lights and materials: `seek` overwrites only
  /// animated cameras and lights.
  [[nodiscard]] virtual SceneDescription& scene() = 0;

  /// Seconds. `start` and `end` are equal if nothing moves.
  [[nodiscard]] virtual double start() const = 0;
  [[nodiscard]] virtual double end() const = 0;
  /// Ascending times of the frames of a sequence of files. Empty if the animation is defined at
  /// every time.
  [[nodiscard]] virtual const std::vector<double>& frame_times() const = 0;

  /// Brings the scene to a time, clamped to [`start`, `end`]; a sequence shows the last frame that
  /// is not later. All threads move vertices. Returns what has changed since the previous call,
  /// which is nothing if the time is the same. Throws `Error` if a file of a sequence cannot be
  /// read; the scene then stays unchanged.
  virtual SceneChanges seek(double seconds) = 0;
  /// The same, for a renderer on a device: the vertices of skins and of morph targets are not
  /// moved, and `SceneChanges::posed` has their poses. The scene has the vertices of an earlier
  /// time until `SceneChanges::move_vertices` or `seek` is called. By default as `seek`.
  virtual SceneChanges seek_poses(double seconds) { return seek(seconds); }

  /// Names of the clips, of which one plays at a time; empty if nothing moves. Clips that drive
  /// different targets share one entry and play together.
  [[nodiscard]] virtual const std::vector<std::string>& clips() const = 0;
  /// Selects the clip of the next `seek`; initially the first. Throws `Error` (kNotFound).
  virtual void play(std::uint32_t clip) = 0;

 protected:
  Animation() = default;
  Animation(const Animation&) = default;
  Animation& operator=(const Animation&) = default;
};

/// The time of a frame in seconds: `frame_times()[frame]` if the animation has frame times, else
/// `start` + frame / `fps`.
[[nodiscard]] double frame_time(const Animation& animation, std::uint64_t frame, double fps);
/// The number of frames up to the end, at least 1. Throws `Error` (kUnsupported) for 2^32 frames or
/// more.
[[nodiscard]] std::uint64_t frame_count(const Animation& animation, double fps);
/// The number of frames of an animation of this length, as above.
[[nodiscard]] std::uint64_t frame_count(double seconds, double fps);

/// The numbers of a few frames, evenly spaced. Automatic settings (camera, light) are chosen for
/// these.
[[nodiscard]] std::vector<std::uint64_t> sample_frames(std::uint64_t frame_count);

/// `add_missing_camera_and_light` for everything that the animation shows, sampled at a few times.
/// Does nothing if the scene has a camera and a light; otherwise seeks.
void add_missing_camera_and_light(Animation& animation);

/// A scene that its rig moves; a rig without clips stays at rest. `threads` = 0 uses all cores.
/// Throws `Error` as `validate` does for the scene and the rig.
[[nodiscard]] std::unique_ptr<Animation> animate(SceneDescription scene, Rig rig,
                                                 std::uint32_t threads = 0);

/// A scene in which nothing moves.
[[nodiscard]] std::unique_ptr<Animation> animate(SceneDescription scene);
/// The scene of a source whose blocks stream, without triangles; nothing moves.
[[nodiscard]] std::unique_ptr<Animation> animate(const GeometrySource& source);

/// A sequence of files, one for each frame, and a static part.
struct SequenceFiles {
  std::string name;
  std::string still;                ///< a static scene file; empty: the frames hold everything
  std::vector<std::string> frames;  ///< at least one
  /// Seconds, ascending, one for each frame; empty: 24 frames per second.
  std::vector<double> times;
  std::vector<Camera> cameras;  ///< one for each frame, a camera named "moving"; or none
  std::vector<Camera> still_cameras;
  std::vector<Light> lights;
};

/// Reads each frame when it is sought, unless `options` requests preloading. Decodes images that
/// several OBJ materials share once. If a mesh has the same triangles as in the previous frame, it
/// counts as deformed; from the first mesh with different triangles on, all meshes count as
/// replaced. A frame's new warnings are appended to the scene's warnings when the frame is shown.
/// Throws `Error` as `load_scene` does.
[[nodiscard]] std::unique_ptr<Animation> load_sequence(const SequenceFiles& files,
                                                       const LoadOptions& options = {});

/// The files that match a pattern ("frames/cloth_*.ply": * and ? in the last part), in the order of
/// the numbers in their names. Throws `Error` (kNotFound) if no file matches.
[[nodiscard]] std::vector<std::string> files_like(const std::string& pattern);

/// Loads an animation: glTF with its nodes, skins and morph targets, a sequence described by JSON
/// (docs/animation.md), or a pattern of files that are a sequence. Anything else that `load_scene`
/// reads becomes a static scene. Throws `Error` as `load_scene` does.
[[nodiscard]] std::unique_ptr<Animation> load_animation(const std::string& path,
                                                        const LoadOptions& options = {});

}  // namespace raysheaf
