#include "camera_rig.h"

#include <cstring>

namespace raysheaf::viewer {
namespace {

constexpr float kSteepest = 89.99f * kPi / 180;
/// The sine of the pitch from which a camera looks straight up or down.
constexpr float kPole = 1 - 1e-6f;

bool is_empty(const Box& box) {
  return !(box.min.x <= box.max.x && box.min.y <= box.max.y && box.min.z <= box.max.z);
}

}  // namespace

CameraRig::Axes CameraRig::world_axes(UpAxis up) {
  Viewpoint front;
  front.view = ViewSide::kFront;
  front.up = up;
  ViewFit fit(front);
  fit.add(Box{{-1, -1, -1}, {1, 1, 1}});
  const Affine camera = fit.camera().to_world;
  return {column(camera, 0), column(camera, 2) * -1.0f, column(camera, 1)};
}

CameraRig::CameraRig(const Camera& camera, const Box& bounds, UpAxis up)
    : camera_(camera), up_(up), world_(world_axes(up)), eye_(column(camera.to_world, 3)) {
  const Axes& world = world_;
  const Vec3 ahead = normalized(column(camera.to_world, 2) * -1.0f);
  pitch_ = std::asin(std::clamp(dot(ahead, world.up), -1.0f, 1.0f));
  pitch_ = std::clamp(pitch_, -kSteepest, kSteepest);
  const Vec3 given = normalized(column(camera.to_world, 0));
  // At the pole yaw and roll turn the image in the same way: the roll is 0.
  const bool is_at_pole = std::fabs(dot(ahead, world.up)) > kPole;
  yaw_ = is_at_pole ? std::atan2(-dot(given, world.ahead), dot(given, world.right))
                    : std::atan2(dot(ahead, world.right), dot(ahead, world.ahead));
  const Vec3 right = world.right * std::cos(yaw_) - world.ahead * std::sin(yaw_);
  const Vec3 above = cross(right, ahead);
  roll_ = std::atan2(dot(given, above), dot(given, right));
  if (std::fabs(roll_) < 1e-3f) roll_ = 0;
  const float size = is_empty(bounds) ? 1 : std::max(length(bounds.max - bounds.min), 1e-12f);
  const Vec3 centre = is_empty(bounds) ? eye_ + ahead : mix(bounds.min, bounds.max, 0.5f);
  smallest_ = 1e-6f * size;
  largest_ = 1e6f * size;
  distance_ = std::clamp(dot(centre - eye_, ahead), 0.05f * size, 100 * size);
}

Vec3 CameraRig::forward() const {
  const Axes& world = world_;
  const Vec3 level = world.right * std::sin(yaw_) + world.ahead * std::cos(yaw_);
  return level * std::cos(pitch_) + world.up * std::sin(pitch_);
}

void CameraRig::place() {
  const Axes& world = world_;
  const Vec3 ahead = forward();
  const Vec3 level = world.right * std::cos(yaw_) - world.ahead * std::sin(yaw_);
  const Vec3 above = cross(level, ahead);
  const float c = std::cos(roll_), s = std::sin(roll_);
  set_column(camera_.to_world, 0, level * c + above * s);
  set_column(camera_.to_world, 1, above * c - level * s);
  set_column(camera_.to_world, 2, ahead * -1.0f);
  set_column(camera_.to_world, 3, eye_);
}

void CameraRig::turn(float yaw, float pitch) {
  yaw_ = std::remainder(yaw_ + yaw, 2 * kPi);
  pitch_ = std::clamp(pitch_ + pitch, -kSteepest, kSteepest);
}

void CameraRig::orbit(float yaw, float pitch) {
  const Vec3 pivot = this->pivot();
  turn(yaw, pitch);
  eye_ = pivot - forward() * distance_;
  place();
}

void CameraRig::look(float yaw, float pitch) {
  turn(yaw, pitch);
  place();
}

void CameraRig::pan(float right, float up) {
  const float height =
      camera_.orthographic ? 2 * camera_.y_mag : 2 * distance_ * std::tan(camera_.y_fov / 2);
  fly(0, right * height, up * height);
}

void CameraRig::zoom(float factor) {
  const Vec3 pivot = this->pivot();
  if (camera_.orthographic) {
    camera_.y_mag = std::clamp(camera_.y_mag * factor, smallest_, largest_);
    return;
  }
  distance_ = std::clamp(distance_ * factor, smallest_, largest_);
  eye_ = pivot - forward() * distance_;
  place();
}

void CameraRig::fly(float forward, float right, float up) {
  place();
  eye_ = eye_ + this->forward() * forward + column(camera_.to_world, 0) * right +
         column(camera_.to_world, 1) * up;
  place();
}

void CameraRig::frame(const Box& bounds) {
  if (is_empty(bounds)) return;
  const float radius = std::max(length(bounds.max - bounds.min) / 2, smallest_);
  distance_ = radius / std::sin(std::min(camera_.y_fov, 2.5f) / 2);
  if (camera_.orthographic) camera_.y_mag = radius;
  eye_ = mix(bounds.min, bounds.max, 0.5f) - forward() * distance_;
  place();
}

void CameraRig::look_from(std::optional<ViewSide> side, const Box& bounds, float aspect) {
  if (is_empty(bounds)) return;
  Viewpoint viewpoint;
  viewpoint.view = side;
  viewpoint.up = up_;
  viewpoint.aspect_ratio = aspect;
  viewpoint.orthographic = camera_.orthographic;
  if (!camera_.orthographic) viewpoint.fov = camera_.y_fov;
  ViewFit fit(viewpoint);
  fit.add(bounds);
  Camera camera = camera_;
  const Camera fitted = fit.camera();
  camera.to_world = fitted.to_world;
  camera.y_mag = fitted.y_mag;
  *this = CameraRig(camera, bounds, up_);
}

void CameraRig::set_orthographic(bool on, const Box& bounds) {
  if (on == camera_.orthographic) return;
  const Vec3 pivot = this->pivot();
  const float slope = std::tan(camera_.y_fov / 2);
  if (on) {
    camera_.y_mag = std::clamp(distance_ * slope, smallest_, largest_);
    if (!is_empty(bounds)) {
      // The sphere around the box, seen from the pivot.
      const float reach = length(mix(bounds.min, bounds.max, 0.5f) - pivot) +
                          0.5f * length(bounds.max - bounds.min);
      distance_ = std::max(distance_, reach);
    }
  } else {
    distance_ = std::clamp(camera_.y_mag / slope, smallest_, largest_);
  }
  camera_.orthographic = on;
  eye_ = pivot - forward() * distance_;
  place();
}

void CameraRig::set_pivot(Vec3 point) {
  if (is_finite(point)) distance_ = std::max(dot(point - eye_, forward()), smallest_);
}

bool same_camera(const Camera& a, const Camera& b) {
  return std::memcmp(&a.to_world, &b.to_world, sizeof a.to_world) == 0 &&
         a.orthographic == b.orthographic && a.y_fov == b.y_fov && a.y_mag == b.y_mag &&
         a.aspect_ratio == b.aspect_ratio;
}

}  // namespace raysheaf::viewer
