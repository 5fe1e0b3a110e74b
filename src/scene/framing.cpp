// A camera and a light for scenes that bring none.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vec.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {
namespace {

/// What a camera has to show: a sphere around the scene's box. A scene without extent gets some, so
/// that planes and distances stay apart.
struct Subject {
  Vec3 center{0, 0, 0};
  float radius = 1;
};

Subject subject_of(const SceneDescription& scene) {
  constexpr double kLargest = 1e18;
  const Box box = world_bounds(scene);
  Subject subject;
  double half_squared = 0, farthest = 0;
  float* const center[3] = {&subject.center.x, &subject.center.y, &subject.center.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double low = component(box.min, axis), high = component(box.max, axis);
    if (!(low >= -kLargest && low <= high && high <= kLargest)) return {};
    *center[axis] = static_cast<float>((low + high) / 2);
    half_squared += (high - low) * (high - low) / 4;
    farthest = std::max({farthest, std::fabs(low), std::fabs(high)});
  }
  // At least eight float32 spacings: in fewer, the camera's position would not resolve the scene.
  constexpr double kLeastExtent = 1e-6;
  const double radius = std::max(std::sqrt(half_squared), kLeastExtent * farthest);
  if (radius > 0) subject.radius = static_cast<float>(radius);
  return subject;
}

}  // namespace

Camera framing_camera(const SceneDescription& scene) {
  constexpr float kFieldOfView = std::numbers::pi_v<float> / 3;
  constexpr float kMargin = 1.1f;
  const Vec3 to_eye = normalized({0.6f, 0.45f, 1});
  const Subject subject = subject_of(scene);
  // The edge of the view touches a ball of radius r from a distance of r / sin(fov / 2).
  const float distance = kMargin * subject.radius / std::sin(kFieldOfView / 2);
  Camera camera;
  camera.name = "framing";
  camera.to_world = look_at(subject.center + to_eye * distance, subject.center, {0, 1, 0});
  camera.y_fov = kFieldOfView;
  camera.z_near = (distance - subject.radius) / 8;
  camera.z_far = (distance + subject.radius) * 2;
  return camera;
}

Light showing_light(const SceneDescription& scene, const Camera& camera) {
  const Subject subject = subject_of(scene);
  const Vec3 eye = column(camera.to_world, 3);
  const float distance = length(eye - subject.center);
  // A camera within the scene may have a wall near by: the light keeps close to it there.
  const float offset = distance > subject.radius ? 0.5f * distance : 0.05f * subject.radius;
  const Vec3 up = normalized(column(camera.to_world, 1), {0, 1, 0});
  const Vec3 left = -normalized(column(camera.to_world, 0), {1, 0, 0});
  Light light;
  light.name = "showing";
  light.position = eye + (up + left * 0.7f) * offset;
  // White that faces the light at the scene's centre has a radiance of 1: intensity / (pi d^2).
  const float reach = std::max(length(light.position - subject.center), 0.5f * subject.radius);
  const float intensity = std::numbers::pi_v<float> * reach * reach;
  light.intensity = {intensity, intensity, intensity};
  return light;
}

bool needs_light(const SceneDescription& scene) {
  if (!scene.lights.empty() || !scene.environment.empty()) return false;
  const auto unlit = [](const Material& material) { return material.unlit; };
  return scene.materials.empty() ||
         !std::all_of(scene.materials.begin(), scene.materials.end(), unlit);
}

void add_missing_camera_and_light(SceneDescription& scene) {
  if (scene.cameras.empty()) scene.cameras.push_back(framing_camera(scene));
  if (needs_light(scene)) scene.lights.push_back(showing_light(scene, scene.cameras.front()));
}

}  // namespace raysheaf
