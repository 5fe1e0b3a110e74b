// Cameras: found by name, turned around a scene, led along a path.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf {

/// A scene's camera by name, then by index; empty: the first, or one that frames the scene where it
/// has none. Throws `Error` (kNotFound) naming the cameras that there are.
[[nodiscard]] Camera find_camera(const SceneDescription& scene, const std::string& wanted);

/// The size of a camera's picture where none is given: 512 pixels along the longer side, in the
/// shape of its `aspect_ratio`, or square.
struct DefaultSize {
  std::uint32_t width = 512, height = 512;
};
[[nodiscard]] DefaultSize default_size(const Camera& camera);

/// The camera after so many turns, counter-clockwise seen from above, about the vertical through
/// `center`; after a whole number of turns, the same bits. `up`: the vertical, a unit vector.
[[nodiscard]] Camera turned_camera(const Camera& camera, Vec3 center, double turns,
                                   Vec3 up = {0, 1, 0});

/// Where a camera is at a time, and where it looks.
struct CameraKey {
  double time = 0;  ///< seconds
  Vec3 position, look_at;
  Vec3 up{0, 1, 0};
  float y_fov = 1.04719755f;  ///< full vertical angle
};

struct CameraPath {
  /// Whether the camera glides through its keys, with the velocity that its neighbours have between
  /// them (Catmull & Rom 1974), or runs straight from one to the next.
  bool smooth = true;
  std::vector<CameraKey> keys;  ///< one at least; times ascend
};

/// Throws `Error` (kInvalidData) that names the first field with which there is no picture.
void validate(const CameraPath& path);

/// The camera at a time; before the first key and after the last it stands. The path has passed
/// `validate`. Throws `Error` (kInvalidData, place `camera path`) where the camera, between two
/// keys, comes to look at itself or along `up`.
[[nodiscard]] Camera camera_at(const CameraPath& path, double time);

/// Reads the JSON that docs/animation.md describes. Throws `Error` whose place is the file and the
/// field.
[[nodiscard]] CameraPath load_camera_path(const std::string& path);

}  // namespace raysheaf
