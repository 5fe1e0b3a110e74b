// From where a picture looks at a whole model, and the camera that fills the picture with it.
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

#include "raysheaf/scene_description.h"

namespace raysheaf {

class Animation;       // raysheaf/animation.h
class GeometrySource;  // raysheaf/stream.h

/// The side that is seen. `kIso` looks from above the right front corner along the diagonal of a
/// cube. Names: "front", "back", "left", "right", "top", "bottom", "iso".
enum class ViewSide : std::uint8_t { kFront, kBack, kLeft, kRight, kTop, kBottom, kIso };

/// The model's axis that points up in the picture: "x", "y", "z", "-x", "-y", "-z". With y up, the
/// model's front faces +z, and its right side is at +x; with z up, the front faces -y.
enum class UpAxis : std::uint8_t { kX, kY, kZ, kMinusX, kMinusY, kMinusZ };

/// Throw `Error` (kInvalidArgument) that lists the names.
[[nodiscard]] ViewSide view_from_string(std::string_view name);
[[nodiscard]] UpAxis up_axis_from_string(std::string_view name);
/// The axis as a unit vector.
[[nodiscard]] Vec3 direction_of(UpAxis up);

/// The vertical field of view of cameras that nothing else is known of: 40 degrees.
inline constexpr float kFramingFov = 0.698131701f;

struct Viewpoint {
  std::optional<ViewSide> view;  ///< none: from the front, a little above and to the right
  UpAxis up = UpAxis::kY;
  /// The camera's place; none: as near as the whole model can be seen from.
  std::optional<Vec3> position;
  std::optional<Vec3> look_at;  ///< with `position`; none: the middle of the model's box
  std::optional<float> fov;     ///< full vertical angle, radians; none: `kFramingFov`
  bool orthographic = false;
  float zoom = 1;  ///< magnifies the picture about its centre
  /// Width over height of the picture that the model fills. Narrower pictures show the whole model
  /// too.
  float aspect_ratio = 1;
  /// The camera will be turned about the vertical axis through the middle of the model's box
  /// (`turned_camera`), and nothing may leave the picture on the way.
  bool all_around = false;
};

/// Throws `Error` (kInvalidArgument) whose place is the field: numbers that are not finite or out
/// of their range, fields that contradict each other.
void validate(const Viewpoint& viewpoint);

/// Finds the camera for triangles that are added one by one, in any order: the order does not
/// change a bit of it.
class ViewFit {
 public:
  /// Throws as `validate` does.
  explicit ViewFit(const Viewpoint& viewpoint);

  /// Corners in world space. Triangles without area, which nothing shows, count only where no
  /// triangle has an area.
  void add(const std::array<Vec3, 3>& triangle);
  void add(const SceneDescription& scene);
  /// The corners of a box.
  void add(const Box& box);

  /// The perspective camera's distance, or the height of what the orthographic camera sees, is the
  /// least at which all corners lie within the middle 92 % of a picture of `aspect_ratio`: their
  /// bounding box in the picture spans 92 % of its width or of its height. Cameras with a position
  /// keep it. Throws `Error` (kInvalidArgument) where the camera would look nowhere, or along `up`.
  [[nodiscard]] Camera camera() const;
  /// The bounds of all that has been added; empty before.
  [[nodiscard]] const Box& bounds() const;

 private:
  /// The box of some points, and how far they reach along the directions in which the view is
  /// limited.
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
  double tan_x_ = 1, tan_y_ = 1;  ///< half of the model's extents in the picture, at depth 1
  std::array<std::array<double, 3>, 3> axes_;    ///< right, up and back
  std::array<std::array<double, 3>, 6> limits_;  ///< the directions of `Reach::along`
  Reach with_area_, all_;
};

/// The camera of a `ViewFit` over all that there is. Throws as `ViewFit::camera` does.
[[nodiscard]] Camera framing_camera(const SceneDescription& scene, const Viewpoint& viewpoint);
/// For all that the animation comes to show, judged by a few times: seeks.
[[nodiscard]] Camera framing_camera(Animation& animation, const Viewpoint& viewpoint);
/// By the boxes of the blocks: nothing is read.
[[nodiscard]] Camera framing_camera(const GeometrySource& source, const Viewpoint& viewpoint);

/// Magnifies what a camera sees, about the picture's centre. Throws `Error` (kInvalidArgument,
/// place "zoom") where `zoom` is not a number above 0, or so large or small that nothing is left.
[[nodiscard]] Camera zoomed(Camera camera, float zoom);

}  // namespace raysheaf
