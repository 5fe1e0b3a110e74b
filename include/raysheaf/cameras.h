// Cameras: finding them by name, turning them around a scene, moving them along a path.
#pragma once

#include <cstdint>
#include <string>
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

}  // namespace raysheaf
