// Primary rays: one through the centre of each pixel.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/trigonometry.h"
#include "base/vec.h"
#include "raysheaf/scene_description.h"
#include "render/rays/sample_body.h"

namespace raysheaf {

/// A camera prepared for one image size. The axes have unit length and are orthogonal unless the
/// camera's map shears, or the image was moved.
struct CameraFrame {
  Vec3 eye, right, up;
  Vec3 forward;  ///< towards the image's centre, at unit depth
  float half_width = 1,
        half_height = 1;  ///< half of the visible extent at depth 1; orthographic: at any depth
  float z_near = 0, z_far = std::numeric_limits<float>::infinity();
  std::uint32_t width = 1, height = 1;
  bool orthographic = false;
  // A thin lens around the eye; the sample determines the point of the lens through which a pixel's
  // ray passes.
  float lens_radius = 0, focus = 1;  ///< the depth in focus; not used without a lens
  SampleOf sample;
};

/// `column(a, c)` normalized in binary64, so that no scale of the map under- or overflows.
inline Vec3 unit_column(const Affine& a, int c) {
  const double x = a.m[0][c], y = a.m[1][c], z = a.m[2][c];
  const double n = std::sqrt(x * x + y * y + z * z);
  return {static_cast<float>(x / n), static_cast<float>(y / n), static_cast<float>(z / n)};
}

/// The linear part of `camera.to_world` must not be singular; its scale does not matter (glTF 2.0,
/// section 3.10). The image's shape sets the horizontal extent; both extents grow if that is
/// narrower than the camera's aspect ratio.
inline CameraFrame make_camera_frame(const Camera& camera, std::uint32_t width,
                                     std::uint32_t height) {
  CameraFrame frame;
  frame.eye = column(camera.to_world, 3);
  frame.right = unit_column(camera.to_world, 0);
  frame.up = unit_column(camera.to_world, 1);
  frame.forward = -unit_column(camera.to_world, 2);
  frame.half_height = camera.orthographic
                          ? camera.y_mag
                          : static_cast<float>(portable::tangent(camera.y_fov * 0.5));
  const float shape = static_cast<float>(width) / static_cast<float>(height);
  if (shape < camera.aspect_ratio) frame.half_height *= camera.aspect_ratio / shape;
  frame.half_width = frame.half_height * shape;
  frame.z_near = camera.z_near > 0 ? camera.z_near : 0;
  frame.z_far = camera.z_far;
  frame.width = width;
  frame.height = height;
  frame.orthographic = camera.orthographic;
  return frame;
}

/// The same camera with every ray moved by `pixels` of the image, x to the right and y down:
/// perspective shears the view, orthographic moves the eye. Everything computed from a frame also
/// works for this one, because the axes need not be orthogonal.
inline CameraFrame moved_by_pixels(CameraFrame frame, Vec2 pixels) {
  if (pixels.x == 0 && pixels.y == 0) return frame;
  const float x = 2 * pixels.x / static_cast<float>(frame.width) * frame.half_width;
  const float y = 2 * pixels.y / static_cast<float>(frame.height) * frame.half_height;
  Vec3& moved = frame.orthographic ? frame.eye : frame.forward;
  moved = moved + frame.right * x - frame.up * y;
  return frame;
}

/// The position of the centre of pixel `i` of `count` between the image's edges at -1 and 1.
RAYSHEAF_HD inline float pixel_center(std::uint32_t i, std::uint32_t count) {
  const auto twice = 2 * static_cast<std::int64_t>(i) + 1 - static_cast<std::int64_t>(count);
  return static_cast<float>(twice) / static_cast<float>(count);
}

/// Maps the unit square to the unit disc and preserves ratios of areas (P. Shirley, K. Chiu, "A Low
/// Distortion Map Between Disk and Square", JGT 2(3), 1997).
RAYSHEAF_HD inline Vec2 on_disc(Vec2 square) {
  const float x = 2 * square.x - 1, y = 2 * square.y - 1;
  if (x == 0 && y == 0) return {0, 0};
  const bool wide = std::fabs(x) > std::fabs(y);
  const float radius = wide ? x : y;
  const Vec2 place = on_circle(wide ? 0.125f * (y / x) : 0.25f - 0.125f * (x / y));
  return {radius * place.x, radius * place.y};
}

/// The ray from another point of the lens that intersects the given ray at the focus. All rays
/// through a thin lens that come from one point in focus continue to one point behind it (R. Cook,
/// T. Porter, L. Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984).
RAYSHEAF_HD inline Ray through_lens(const CameraFrame& frame, Ray ray, Vec2 chosen) {
  const Vec2 place = on_disc(chosen) * frame.lens_radius;
  const Vec3 aside = frame.right * place.x + frame.up * place.y;
  ray.origin += aside;
  ray.direction = ray.direction - aside / frame.focus;
  return ray;
}

/// The offset of a column of pixels to the right of the image's middle, and of a row above it, at
/// depth 1; orthographic: at any depth.
RAYSHEAF_HD inline Vec3 column_right(const CameraFrame& frame, std::uint32_t x) {
  return frame.right * (pixel_center(x, frame.width) * frame.half_width);
}
RAYSHEAF_HD inline Vec3 row_up(const CameraFrame& frame, std::uint32_t y) {
  return frame.up * (pixel_center(y, frame.height) * frame.half_height);
}

/// From the eye, ignoring the lens. `aside`: from the image's middle to the pixel.
RAYSHEAF_HD inline Ray pinhole_ray(const CameraFrame& frame, Vec3 aside) {
  if (frame.orthographic) return {frame.eye + aside, frame.z_near, frame.forward, frame.z_far};
  return {frame.eye, frame.z_near, frame.forward + aside, frame.z_far};
}

/// `camera_ray` for a known offset of the pixel from the image's middle.
RAYSHEAF_HD inline Ray camera_ray(const CameraFrame& frame, std::uint32_t x, std::uint32_t y,
                                  Vec3 aside) {
  const Ray ray = pinhole_ray(frame, aside);
  if (!(frame.lens_radius > 0)) return ray;
  const std::uint32_t seed = choice_seed(Choice::kLens, y * frame.width + x, 0, 0);
  return through_lens(frame, ray, sample_pair(frame.sample, seed));
}

/// The ray through the centre of a pixel; (0, 0) is the top left one. Its direction has length 1
/// along the camera's axis, so that `t` is the depth, and ranges from z_near to z_far.
RAYSHEAF_HD inline Ray camera_ray(const CameraFrame& frame, std::uint32_t x, std::uint32_t y) {
  return camera_ray(frame, x, y, column_right(frame, x) - row_up(frame, y));
}

}  // namespace raysheaf
