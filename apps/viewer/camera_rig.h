// The camera that the user moves: where it is, and where it looks.
//
//        up                      forward(yaw, pitch)
//         |  pitch              eye ─────────────────────► pivot
//         | /                        distance
//   yaw  (+)──► right           orbit: the pivot stays.  look, fly: only the eye moves.
#pragma once

#include <optional>

#include "raysheaf/cameras.h"
#include "raysheaf/scene_description.h"
#include "vec.h"

namespace raysheaf::viewer {

/// A camera that is taken over stays unchanged, bit for bit, until it is moved. Angles are in
/// radians. Its roll is kept; its scale and mirroring are dropped with the first move.
class CameraRig {
 public:
  CameraRig() = default;
  /// `bounds` are those of the scene; the pivot is at the depth of their centre.
  CameraRig(const Camera& camera, const Box& bounds, UpAxis up);

  void orbit(float yaw, float pitch);
  void look(float yaw, float pitch);
  /// Moves sideways, in units of the visible height at the pivot; the pivot moves along.
  void pan(float right, float up);
  /// Multiplies the distance to the pivot by `factor`, which is above 0; an orthographic camera
  /// keeps its distance, and what it shows becomes larger or smaller.
  void zoom(float factor);
  /// Moves in scene units, along the camera's own axes; the pivot moves along.
  void fly(float forward, float right, float up);
  /// Moves back so that all of `bounds` is visible, from the same side.
  void frame(const Box& bounds);
  /// Looks at `bounds` from one of their sides (none: from the front, slightly above and to the
  /// right), as near as the whole box is in the image; keeps the
  /// field of view, and whether the camera is orthographic.
  void look_from(std::optional<ViewSide> side, const Box& bounds, float aspect);
  /// Parallel rays, or a perspective, with the same extent at the pivot. A camera that becomes
  /// orthographic moves back until all of `bounds` is in front of it.
  void set_orthographic(bool on, const Box& bounds);
  /// Sets the pivot for orbiting to the point on the view axis at the depth of `point`, so that the
  /// camera does not turn.
  void set_pivot(Vec3 point);

  [[nodiscard]] const Camera& camera() const { return camera_; }
  [[nodiscard]] Vec3 pivot() const { return eye_ + forward() * distance_; }
  [[nodiscard]] Vec3 eye() const { return eye_; }
  [[nodiscard]] Vec3 forward() const;
  [[nodiscard]] float distance() const { return distance_; }
  /// The direction that points up in the image of a level camera.
  [[nodiscard]] Vec3 up() const { return world_.up; }
  [[nodiscard]] float yaw() const { return yaw_; }
  [[nodiscard]] float pitch() const { return pitch_; }

 private:
  struct Axes {
    Vec3 right, ahead, up;
  };
  /// Those of a camera that sees the front.
  [[nodiscard]] static Axes world_axes(UpAxis up);
  void turn(float yaw, float pitch);
  void place();  ///< computes the camera from all other members

  Camera camera_;
  UpAxis up_ = UpAxis::kY;
  Axes world_{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
  Vec3 eye_;
  float yaw_ = 0, pitch_ = 0, roll_ = 0, distance_ = 1;
  float smallest_ = 1e-6f, largest_ = 1e6f;  ///< distance to the pivot
};

/// Whether both cameras see the same image.
[[nodiscard]] bool same_camera(const Camera& a, const Camera& b);

}  // namespace raysheaf::viewer
