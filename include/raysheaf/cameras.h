// Cameras: finding them by name, turning them around a scene, moving them along a path, and
// viewpoints from which a camera shows a whole model.
//
//   raysheaf::Viewpoint view;
//   view.view = raysheaf::ViewSide::kFront;
//   view.up = raysheaf::UpAxis::kZ;
//   view.aspect_ratio = 400.0f / 300.0f;
//   scene.cameras = {raysheaf::framing_camera(scene, view)};
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf {

/// Finds a scene's camera by name, then by index. If `wanted` is empty, returns the first camera,
/// or one that frames the scene if it has none. Throws `Error` (kNotFound) naming the scene's
/// cameras.
[[nodiscard]] Camera find_camera(const SceneDescription& scene, const std::string& wanted);

/// The default size of a camera's image: 512 pixels along the longer side, with the camera's
/// `aspect_ratio`, or square.
struct DefaultSize {
  std::uint32_t width = 512, height = 512;
};
[[nodiscard]] DefaultSize default_size(const Camera& camera);

/// Turns the camera about the vertical axis through `center`, counter-clockwise seen from above;
/// whole numbers of turns return the same bits. `up`: the vertical, a unit vector.
[[nodiscard]] Camera turned_camera(const Camera& camera, Vec3 center, double turns,
                                   Vec3 up = {0, 1, 0});

/// A camera's position and target at a time.
struct CameraKey {
  double time = 0;  ///< seconds
  Vec3 position, look_at;
  Vec3 up{0, 1, 0};
  float y_fov = 1.04719755f;  ///< full vertical angle, radians
};

struct CameraPath {
  /// Whether the camera follows a smooth curve through its keys, whose velocity at a key is that
  /// between the neighbouring keys (Catmull & Rom 1974), or moves straight from key to key.
  bool smooth = true;
  std::vector<CameraKey> keys;  ///< at least one; times ascend
};

/// Throws `Error` (kInvalidData) naming the first invalid field.
void validate(const CameraPath& path);

/// The camera at a time; it stands still before the first key and after the last. The path must
/// have passed `validate`. Throws `Error` (kInvalidData, place `camera path`) if between two keys
/// the camera and its target coincide, or the camera looks along `up`.
[[nodiscard]] Camera camera_at(const CameraPath& path, double time);

/// Reads the JSON that docs/animation.md describes. Throws `Error` whose place is the file and the
/// field.
[[nodiscard]] CameraPath load_camera_path(const std::string& path);

class Animation;       // raysheaf/animation.h
class GeometrySource;  // raysheaf/stream.h

/// The side that is seen. `kIso` looks from above the right front corner along the diagonal of a
/// cube. Names: "front", "back", "left", "right", "top", "bottom", "iso".
enum class ViewSide : std::uint8_t { kFront, kBack, kLeft, kRight, kTop, kBottom, kIso };

/// The model's axis that points up in the image: "x", "y", "z", "-x", "-y", "-z". With y up, the
/// model's front faces +z, and its right side is at +x; with z up, the front faces -y.
enum class UpAxis : std::uint8_t { kX, kY, kZ, kMinusX, kMinusY, kMinusZ };

/// Throw `Error` (kInvalidArgument) listing the valid names.
[[nodiscard]] ViewSide view_from_string(std::string_view name);
[[nodiscard]] UpAxis up_axis_from_string(std::string_view name);
/// The axis as a unit vector.
[[nodiscard]] Vec3 direction_of(UpAxis up);

/// The default vertical field of view: 40 degrees.
inline constexpr float kFramingFov = 0.698131701f;

struct Viewpoint {
  std::optional<ViewSide> view;  ///< none: from the front, slightly above and to the right
  UpAxis up = UpAxis::kY;
  /// The camera's position; none: as near as possible with the whole model in the image.
  std::optional<Vec3> position;
  std::optional<Vec3> look_at;  ///< requires `position`; none: the middle of the model's box
  std::optional<float> fov;     ///< full vertical angle, radians; none: `kFramingFov`
  bool orthographic = false;
  float zoom = 1;  ///< magnifies the image about its centre
  /// Width over height of the image that the model fills. Narrower images also show the whole
  /// model.
  float aspect_ratio = 1;
  /// The camera will be turned about the vertical axis through the middle of the model's box
  /// (`turned_camera`), and the model must stay in the image at every angle.
  bool all_around = false;
};

/// Throws `Error` (kInvalidArgument) whose place is the field, for numbers that are not finite or
/// out of range and for fields that contradict each other.
void validate(const Viewpoint& viewpoint);

/// Finds the camera for triangles that are added one by one. Their order does not change a bit of
/// the result.
class ViewFit {
 public:
  /// Throws as `validate` does.
  explicit ViewFit(const Viewpoint& viewpoint);

  /// Corners in world space. Triangles without area are invisible and count only if no triangle has
  /// an area.
  void add(const std::array<Vec3, 3>& triangle);
  void add(const SceneDescription& scene);
  /// The corners of a box.
  void add(const Box& box);

  /// The camera for the added triangles. The distance of a perspective camera, or the height of an
  /// orthographic camera's view, is the least at which all corners lie within the middle 92 % of an
  /// image of `aspect_ratio`: their bounding box in the image spans 92 % of its width or of its
  /// height. A camera with a given position keeps it. Throws `Error` (kInvalidArgument) if the
  /// camera and its target coincide, or if the camera looks along `up`.
  [[nodiscard]] Camera camera() const;
  /// The bounds of everything added; empty before.
  [[nodiscard]] const Box& bounds() const;

 private:
  /// The box of some points, and their maximum along the directions that limit the view.
  struct Reach {
    Box box;
    std::array<double, 6> along;
    Reach();
  };
  void enlarge(Reach* reach, Vec3 point) const;
  [[nodiscard]] Camera automatic(const Reach& reach) const;
  [[nodiscard]] Camera placed(const Reach& reach) const;
  [[nodiscard]] Reach turned(const Reach& reach) const;

  Viewpoint viewpoint_;
  double tan_x_ = 1, tan_y_ = 1;  ///< half of the model's extents in the image, at depth 1
  std::array<std::array<double, 3>, 3> axes_;    ///< right, up and back
  std::array<std::array<double, 3>, 6> limits_;  ///< the directions of `Reach::along`
  Reach with_area_, all_;
};

/// The camera of a `ViewFit` of the whole scene. Throws as `ViewFit::camera` does.
[[nodiscard]] Camera framing_camera(const SceneDescription& scene, const Viewpoint& viewpoint);
/// For everything that the animation shows, sampled at a few times: seeks.
[[nodiscard]] Camera framing_camera(Animation& animation, const Viewpoint& viewpoint);
/// Uses the boxes of the blocks; reads no block.
[[nodiscard]] Camera framing_camera(const GeometrySource& source, const Viewpoint& viewpoint);

/// Whether a camera shows a scene: the triangles' parts within the view frustum span at least half
/// of the image's width or of its height. Also true for a scene without triangles. Many exporters
/// write a camera that shows the model small or not at all; raysheaf's program, viewer and Python
/// module then use `framing_camera` unless the user chooses a camera.
[[nodiscard]] bool shows(const Camera& camera, const SceneDescription& scene);
/// The same for the faces of the boxes of the blocks; reads no block.
[[nodiscard]] bool shows(const Camera& camera, const GeometrySource& source);
/// Whether the scene has a camera, and the first one shows the scene at one of a few times: seeks.
[[nodiscard]] bool first_camera_shows(Animation& animation);

/// Magnifies a camera's view about the image's centre. Throws `Error` (kInvalidArgument, place
/// "zoom") if `zoom` is not a positive number, or so large or small that the view is degenerate.
[[nodiscard]] Camera zoomed(Camera camera, float zoom);

}  // namespace raysheaf
