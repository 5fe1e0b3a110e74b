// Primary rays: one through the centre of each pixel.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/vec.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

/// A camera made ready for one picture size. The axes are of unit length; they stand at right
/// angles unless the camera's map shears.
struct CameraFrame {
  Vec3 eye, right, up, forward;
  float half_width = 1,
        half_height = 1;  ///< of what is seen, at depth 1; orthographic: at any depth
  float z_near = 0, z_far = std::numeric_limits<float>::infinity();
  std::uint32_t width = 1, height = 1;
  bool orthographic = false;
};

/// `column(a, c)` with unit length, measured in binary64: no scale of the map under- or overflows.
inline Vec3 unit_column(const Affine& a, int c) {
  const double x = a.m[0][c], y = a.m[1][c], z = a.m[2][c];
  const double n = std::sqrt(x * x + y * y + z * z);
  return {static_cast<float>(x / n), static_cast<float>(y / n), static_cast<float>(z / n)};
}

/// The linear part of `camera.to_world` must not be singular; its scale does not matter (glTF 2.0,
/// section 3.10). The picture's shape sets the horizontal extent.
inline CameraFrame make_camera_frame(const Camera& camera, std::uint32_t width,
                                     std::uint32_t height) {
  CameraFrame frame;
  frame.eye = column(camera.to_world, 3);
  frame.right = unit_column(camera.to_world, 0);
  frame.up = unit_column(camera.to_world, 1);
  frame.forward = -unit_column(camera.to_world, 2);
  frame.half_height = camera.orthographic ? camera.y_mag : std::tan(camera.y_fov * 0.5f);
  frame.half_width = frame.half_height * (static_cast<float>(width) / static_cast<float>(height));
  frame.z_near = camera.z_near > 0 ? camera.z_near : 0;
  frame.z_far = camera.z_far;
  frame.width = width;
  frame.height = height;
  frame.orthographic = camera.orthographic;
  return frame;
}

/// Where the centre of pixel `i` of `count` lies between the picture's edges at -1 and 1.
RAYSHEAF_HD inline float pixel_center(std::uint32_t i, std::uint32_t count) {
  const auto twice = 2 * static_cast<std::int64_t>(i) + 1 - static_cast<std::int64_t>(count);
  return static_cast<float>(twice) / static_cast<float>(count);
}

/// The ray through the centre of a pixel; (0, 0) is the top left one. Its direction has length 1
/// along the camera's axis, so that `t` is the depth, and runs from z_near to z_far.
RAYSHEAF_HD inline Ray camera_ray(const CameraFrame& frame, std::uint32_t x, std::uint32_t y) {
  const Vec3 aside = frame.right * (pixel_center(x, frame.width) * frame.half_width) -
                     frame.up * (pixel_center(y, frame.height) * frame.half_height);
  if (frame.orthographic) return {frame.eye + aside, frame.z_near, frame.forward, frame.z_far};
  return {frame.eye, frame.z_near, frame.forward + aside, frame.z_far};
}

}  // namespace raysheaf
