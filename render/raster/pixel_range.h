// The pixels whose centres a triangle may cover.
#pragma once

#include <cmath>
#include <cstdint>

#include "render/raster/projection.h"

namespace raysheaf {

/// Columns x0 to x1 and rows y0 to y1, inclusive; empty if `x0 > x1` or `y0 > y1`.
struct PixelRange {
  std::int32_t x0, y0, x1, y1;
  float nearest = 0;  ///< a lower bound of t for rays that hit the triangle

  [[nodiscard]] RAYSHEAF_HD bool is_empty() const { return x0 > x1 || y0 > y1; }
  [[nodiscard]] RAYSHEAF_HD std::int64_t area() const {
    return is_empty() ? 0 : std::int64_t{x1 - x0 + 1} * (y1 - y0 + 1);
  }
};

/// The relative error, in proportion to the sum of their terms' magnitudes, of the sums of four
/// products below, and of those of `camera_ray`: a generous gamma(8).
inline constexpr float kProjectionError = 1e-6f;

/// Extends {least x, least y, greatest x, greatest y, least w} by the image position of a point
/// relative to the eye, with the image's edges at -1 and 1, and by its error. Returns false if the
/// point is not in front of the eye.
RAYSHEAF_HD inline bool grow(const ClipMatrix& m, Vec3 p, float (&box)[5]) {
  const Vec3 size = abs(p);
  const float w = m[3] * p.x + m[7] * p.y + m[11] * p.z + m[15];
  const float w_size = std::fabs(m[3]) * size.x + std::fabs(m[7]) * size.y +
                       std::fabs(m[11]) * size.z + std::fabs(m[15]);
  if (!(w > 16 * kProjectionError * w_size)) return false;
  box[4] = std::fmin(box[4], w - 4 * kProjectionError * w_size);
  for (int axis = 0; axis < 2; ++axis) {
    const float seen = (m[axis] * p.x + m[4 + axis] * p.y + m[8 + axis] * p.z) / w;
    const float seen_size = std::fabs(m[axis]) * size.x + std::fabs(m[4 + axis]) * size.y +
                            std::fabs(m[8 + axis]) * size.z;
    const float slack = kProjectionError * (1 + (seen_size + std::fabs(seen) * w_size) / w);
    box[axis] = std::fmin(box[axis], seen - slack);
    box[2 + axis] = std::fmax(box[2 + axis], seen + slack);
  }
  return true;
}

/// Contains every pixel whose `camera_ray` hits the triangle with these corners relative to the
/// eye; the whole image if the triangle extends behind the eye.
RAYSHEAF_HD inline PixelRange pixel_range(const CameraFrame& frame, const ClipMatrix& clip, Vec3 a,
                                          Vec3 b, Vec3 c) {
  const auto width = static_cast<float>(frame.width), height = static_cast<float>(frame.height);
  float box[5] = {2, 2, -2, -2, std::numeric_limits<float>::infinity()};
  if (!grow(clip, a, box) || !grow(clip, b, box) || !grow(clip, c, box)) {
    return {0, 0, static_cast<std::int32_t>(frame.width) - 1,
            static_cast<std::int32_t>(frame.height) - 1};
  }
  const auto first = [](float edge, float count) {
    return static_cast<std::int32_t>(clamp(std::ceil((edge + 1) * 0.5f * count - 0.5f), 0, count));
  };
  const auto last = [](float edge, float count) {
    return static_cast<std::int32_t>(
        clamp(std::floor((edge + 1) * 0.5f * count - 0.5f), -1, count - 1));
  };
  // In perspective clip space, w is the depth.
  return {first(box[0], width), first(box[1], height), last(box[2], width), last(box[3], height),
          frame.orthographic ? 0 : box[4]};
}

}  // namespace raysheaf
