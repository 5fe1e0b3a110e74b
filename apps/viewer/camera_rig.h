// Where the user stands and looks: the camera as the hand moves it.
//
//        up                      forward(yaw, pitch)
//         |  pitch              eye ─────────────────────► pivot
//         | /                        distance
//   yaw  (+)──► right           orbit: the pivot stays.  look, fly: the eye moves alone.
#pragma once

#include <cstdint>

#include "raysheaf/scene_description.h"
#include "vec.h"

namespace raysheaf::viewer {

enum class UpAxis : std::uint8_t { kY, kZ };

/// A camera taken over stays as it is, bit for bit, until it is moved. Angles in radians. A roll
/// that it has stays too; a scale and a mirroring are dropped with the first move.
class CameraRig {
 public:
  CameraRig() = default;
  /// `bounds`: of the scene; the pivot is as far ahead as its centre.
  CameraRig(const Camera& camera, const Box& bounds, UpAxis up);

  void orbit(float yaw, float pitch);
  void look(float yaw, float pitch);
  /// Sidewise, in heights of what is seen at the pivot; the pivot goes along.
  void pan(float right, float up);
  /// The distance to the pivot becomes `factor` times as large; `factor` above 0.
  void zoom(float factor);
  /// In scene units, along the camera's own axes; the pivot goes along.
  void fly(float forward, float right, float up);
  /// Back to where all of `bounds` is seen, from the same side.
  void frame(const Box& bounds);
  /// What orbiting goes round. The camera does not turn: the pivot is the nearest point ahead.
  void set_pivot(Vec3 point);

  [[nodiscard]] const Camera& camera() const { return camera_; }
  [[nodiscard]] Vec3 pivot() const { return eye_ + forward() * distance_; }
  [[nodiscard]] Vec3 eye() const { return eye_; }
  [[nodiscard]] Vec3 forward() const;
  [[nodiscard]] float distance() const { return distance_; }
  [[nodiscard]] float yaw() const { return yaw_; }
  [[nodiscard]] float pitch() const { return pitch_; }

 private:
  struct Axes {
    Vec3 right, ahead, up;
  };
  [[nodiscard]] Axes world_axes() const;
  void turn(float yaw, float pitch);
  void place();  ///< the camera from all the rest

  Camera camera_;
  UpAxis up_ = UpAxis::kY;
  Vec3 eye_;
  float yaw_ = 0, pitch_ = 0, roll_ = 0, distance_ = 1;
  float smallest_ = 1e-6f, largest_ = 1e6f;  ///< distance to the pivot
};

}  // namespace raysheaf::viewer
