#include "raysheaf/cameras.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "animation/curve.h"
#include "base/vec.h"
#include "raysheaf/error.h"

namespace raysheaf {
namespace {

/// Numbers of a key: position, look_at, up, y_fov.
constexpr std::size_t kNumbers = 10;
using KeyNumbers = std::array<double, kNumbers>;

KeyNumbers numbers_of(const CameraKey& key) {
  return {key.position.x, key.position.y, key.position.z, key.look_at.x, key.look_at.y,
          key.look_at.z,  key.up.x,       key.up.y,       key.up.z,      key.y_fov};
}

/// The velocity between the neighbours of a key; at the ends, to the only neighbour.
KeyNumbers tangent(const std::vector<CameraKey>& keys, std::size_t k) {
  const std::size_t before = k == 0 ? 0 : k - 1, after = k + 1 == keys.size() ? k : k + 1;
  const KeyNumbers a = numbers_of(keys[before]), b = numbers_of(keys[after]);
  const double seconds = keys[after].time - keys[before].time;
  KeyNumbers t{};
  for (std::size_t i = 0; seconds > 0 && i < kNumbers; ++i) t[i] = (b[i] - a[i]) / seconds;
  return t;
}

/// Times count from the first key, to keep precision in float.
Curve curve_of(const CameraPath& path) {
  Curve curve;
  curve.interpolation = path.smooth ? Interpolation::kCubicSpline : Interpolation::kLinear;
  const auto append = [&](const KeyNumbers& numbers) {
    for (const double x : numbers) curve.values.push_back(static_cast<float>(x));
  };
  for (std::size_t k = 0; k < path.keys.size(); ++k) {
    curve.times.push_back(static_cast<float>(path.keys[k].time - path.keys[0].time));
    const KeyNumbers velocity = path.smooth ? tangent(path.keys, k) : KeyNumbers{};
    if (path.smooth) append(velocity);
    append(numbers_of(path.keys[k]));
    if (path.smooth) append(velocity);
  }
  return curve;
}

const char* fault_of(const CameraKey& key) {
  const Vec3 ahead = key.look_at - key.position;
  if (!(length(ahead) > 0)) return "look_at";
  if (!(length(cross(normalized(key.up), normalized(ahead))) > 1e-6f)) return "up";
  if (!(key.y_fov > 0 && key.y_fov < std::numbers::pi_v<float>)) return "y_fov";
  return nullptr;
}

std::string camera_names(const SceneDescription& scene) {
  std::string names;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    names += (i == 0 ? "" : ", ") + std::to_string(i);
    if (!scene.cameras[i].name.empty()) names += " \"" + scene.cameras[i].name + "\"";
  }
  return names;
}

}  // namespace

Camera find_camera(const SceneDescription& scene, const std::string& wanted) {
  if (wanted.empty()) return scene.cameras.empty() ? framing_camera(scene) : scene.cameras.front();
  for (const Camera& camera : scene.cameras)
    if (camera.name == wanted) return camera;
  std::size_t index = 0;
  const char* end = wanted.data() + wanted.size();
  const auto [stop, error] = std::from_chars(wanted.data(), end, index);
  if (error == std::errc{} && stop == end && index < scene.cameras.size())
    return scene.cameras[index];
  // The name of the camera that `framing_camera` makes for scenes without cameras.
  const bool is_framed = scene.cameras.size() == 1 && scene.cameras[0].name == "framing";
  throw Error(ErrorCode::kNotFound,
              scene.cameras.empty() || is_framed
                  ? "there is no camera \"" + wanted +
                        "\": the file has no cameras, and without this option one frames the scene"
                  : "the scene has no camera \"" + wanted + "\"; its " +
                        (scene.cameras.size() == 1 ? "only camera is " : "cameras are ") +
                        camera_names(scene),
              "camera");
}

DefaultSize default_size(const Camera& camera) {
  DefaultSize size;
  const double shape = double{camera.aspect_ratio};
  if (!(shape > 0)) return size;
  const auto shorter = [](double part) {
    return static_cast<std::uint32_t>(std::max(1.0, std::round(512 * std::min(part, 1.0))));
  };
  size.width = shorter(shape);
  size.height = shorter(1 / shape);
  return size;
}

Camera turned_camera(const Camera& camera, Vec3 center, double turns, Vec3 up) {
  const double part = turns - std::floor(turns);
  if (part == 0) return camera;
  const Affine turn = rotation(up, static_cast<float>(part * 2 * std::numbers::pi));
  Camera turned = camera;
  turned.to_world =
      compose(translation(center), compose(turn, compose(translation(-center), camera.to_world)));
  return turned;
}

void validate(const CameraPath& path) {
  const auto fail = [](std::size_t k, const char* field, const char* sentence) {
    throw Error(ErrorCode::kInvalidData, sentence, "keys[" + std::to_string(k) + "]." + field);
  };
  if (path.keys.empty()) throw Error(ErrorCode::kInvalidData, "has no keys", "keys");
  for (std::size_t k = 0; k < path.keys.size(); ++k) {
    const CameraKey& key = path.keys[k];
    if (!std::isfinite(key.time)) fail(k, "time", "is not finite");
    // As floats, because the curve stores floats.
    const double first = path.keys[0].time;
    if (k > 0 &&
        !(static_cast<float>(key.time - first) > static_cast<float>(path.keys[k - 1].time - first)))
      fail(k, "time", "is not later than that of the previous key");
    if (!is_finite(key.position)) fail(k, "position", "is not finite");
    if (!is_finite(key.look_at)) fail(k, "look_at", "is not finite");
    if (!is_finite(key.up)) fail(k, "up", "is not finite");
    const char* fault = fault_of(key);
    if (fault == nullptr) continue;
    const std::string field = fault;
    fail(k, fault,
         field == "look_at" ? "is the same point as the position"
         : field == "up"    ? "is parallel to the viewing direction"
                            : "must be above 0 and below 180 degrees");
  }
}

Camera camera_at(const CameraPath& path, double time) {
  double n[kNumbers];
  sample_curve(curve_of(path), time - path.keys[0].time, n);
  const auto vector = [&](std::size_t i) {
    return Vec3{static_cast<float>(n[i]), static_cast<float>(n[i + 1]),
                static_cast<float>(n[i + 2])};
  };
  const CameraKey key{time, vector(0), vector(3), vector(6), static_cast<float>(n[9])};
  if (fault_of(key) != nullptr) {
    throw Error(ErrorCode::kInvalidData,
                "at " + std::to_string(time) +
                    " s, between two keys, the camera looks along its up, or is at its look_at",
                "camera path");
  }
  Camera camera;
  camera.name = "path";
  camera.to_world = look_at(key.position, key.look_at, key.up);
  camera.y_fov = key.y_fov;
  return camera;
}

}  // namespace raysheaf
