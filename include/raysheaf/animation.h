// Scenes that move, brought to any time.
//
//   const std::unique_ptr<raysheaf::Animation> animation = raysheaf::load_animation("walk.glb");
//   raysheaf::Renderer renderer;
//   renderer.show(animation->scene());
//   for (double t = animation->start(); t <= animation->end(); t += 1 / 24.0) {
//     renderer.show(animation->scene(), animation->seek(t));
//     raysheaf::RenderResult picture = renderer.render(options);
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

/// A scene and how to bring it to a time. One call at a time, from any thread.
class Animation {
 public:
  virtual ~Animation() = default;

  /// The scene as the last `seek` left it; at rest, or at the first frame, before any. It stays
  /// where it is. Cameras, lights and materials may be edited: `seek` writes none but the cameras
  /// and lights that move.
  [[nodiscard]] virtual SceneDescription& scene() = 0;

  /// Seconds. Equal where nothing moves.
  [[nodiscard]] virtual double start() const = 0;
  [[nodiscard]] virtual double end() const = 0;
  /// Ascending times of the frames that there are, as of a sequence of files. Empty where any
  /// time has one of its own.
  [[nodiscard]] virtual const std::vector<double>& frame_times() const = 0;

  /// Brings the scene to a time, kept between `start` and `end`; of a sequence to the last frame
  /// that is not later. Vertices are moved by all threads. Returns what is another since the call
  /// before: nothing where time stands still. Throws `Error` where a file of a sequence cannot be
  /// read: the scene then stays as it was.
  virtual SceneChanges seek(double seconds) = 0;

  /// Names of what can be played, one at a time; empty where nothing moves. Clips that drive
  /// different things belong together: they have one entry and play at once.
  [[nodiscard]] virtual const std::vector<std::string>& clips() const = 0;
  /// Which of them the next `seek` is in; the first before any call. Throws kNotFound.
  virtual void play(std::uint32_t clip) = 0;

 protected:
  Animation() = default;
  Animation(const Animation&) = default;
  Animation& operator=(const Animation&) = default;
};

/// The place of a frame in time: `frame_times()[frame]` where there are such; else `start` and
/// further by 1 / `fps` each.
[[nodiscard]] double frame_time(const Animation& animation, std::uint64_t frame, double fps);
/// How many frames there are until the end, one at least. Throws `Error` (kUnsupported) where that
/// is 2^32 or more.
[[nodiscard]] std::uint64_t frame_count(const Animation& animation, double fps);
/// The same of so many seconds.
[[nodiscard]] std::uint64_t frame_count(double seconds, double fps);

/// A few frames, evenly over all that there are: what is automatic is judged by them.
[[nodiscard]] std::vector<std::uint64_t> sample_frames(std::uint64_t frame_count);

/// `add_missing_camera_and_light` for all that the scene comes to show, judged by a few times. Does
/// nothing where neither is missing; seeks otherwise.
void add_missing_camera_and_light(Animation& animation);

/// A scene that its rig moves; a rig without clips stays at rest. `threads` = 0: all cores. Throws
/// `Error` as `validate` does for both.
[[nodiscard]] std::unique_ptr<Animation> animate(SceneDescription scene, Rig rig,
                                                 std::uint32_t threads = 0);

/// A scene in which nothing moves.
[[nodiscard]] std::unique_ptr<Animation> animate(SceneDescription scene);
/// The same of what streams: its scene, without triangles.
[[nodiscard]] std::unique_ptr<Animation> animate(const GeometrySource& source);

/// A sequence of files, each a frame, beside what does not move.
struct SequenceFiles {
  std::string name;
  std::string still;                ///< a scene; empty: everything is in the frames
  std::vector<std::string> frames;  ///< one at least
  std::vector<double> times;        ///< seconds, ascending, one a frame; empty: 24 frames a second
  std::vector<Camera> cameras;      ///< one a frame, a camera named "moving"; or none
  std::vector<Camera> still_cameras;
  std::vector<Light> lights;
};

/// Frames are read when they are sought, unless `options` has them preloaded; pictures that OBJ's
/// materials share are decoded once. Meshes of a frame whose triangles are those of the frame
/// before are taken as deformed; from the first other mesh on they are other ones. The scene's
/// warnings become more where a frame that is shown has others. Throws `Error` as `load_scene`
/// does.
[[nodiscard]] std::unique_ptr<Animation> load_sequence(const SequenceFiles& files,
                                                       const LoadOptions& options = {});

/// The files that a pattern names ("frames/cloth_*.ply": * and ? in the last part), in the order of
/// the numbers in their names. Throws `Error` (kNotFound) where there are none.
[[nodiscard]] std::vector<std::string> files_like(const std::string& pattern);

/// What moves in a file: glTF with its nodes, skins and morph targets; a sequence described by JSON
/// (docs/animation.md); a pattern of files that are a sequence; anything else that `load_scene`
/// reads stands still. Throws `Error` as `load_scene` does.
[[nodiscard]] std::unique_ptr<Animation> load_animation(const std::string& path,
                                                        const LoadOptions& options = {});

}  // namespace raysheaf
