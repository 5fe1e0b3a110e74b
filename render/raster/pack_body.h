// Tests whether one triangle may be visible.
#pragma once

#include <cstdint>

#include "render/raster/projection.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// A camera, an image's size, and the matrix of both.
struct PictureView {
  CameraFrame frame;
  ClipMatrix clip;
};

/// `bounds` must contain the scene.
inline PictureView make_picture_view(const CameraFrame& frame, const Box& bounds) {
  return {frame, clip_matrix(frame, farthest_depth(frame, bounds))};
}

/// The sides of the frustum outside which a point relative to the eye lies, one bit each. Points
/// behind a perspective eye may be outside all.
RAYSHEAF_HD inline std::uint32_t outside(const ClipMatrix& m, Vec3 p) {
  const float x = m[0] * p.x + m[4] * p.y + m[8] * p.z;
  const float y = m[1] * p.x + m[5] * p.y + m[9] * p.z;
  const float z = m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14];
  const float w = m[3] * p.x + m[7] * p.y + m[11] * p.z + m[15];
  return std::uint32_t{x > w} | std::uint32_t{x < -w} << 1 | std::uint32_t{y > w} << 2 |
         std::uint32_t{y < -w} << 3 | std::uint32_t{z > w} << 4 | std::uint32_t{z < 0} << 5;
}

/// Six times the volume of the tetrahedron of eye and triangle; orthographic: of a prism along the
/// view. Negative if the corners are counter-clockwise for the eye. In binary64 the products keep
/// nearly all their bits, so the sign is only wrong for triangles that no ray could decide either.
RAYSHEAF_HD inline double facing(const CameraFrame& frame, Vec3 a, Vec3 b, Vec3 c) {
  const double ab[3] = {double{b.x} - a.x, double{b.y} - a.y, double{b.z} - a.z};
  const double ac[3] = {double{c.x} - a.x, double{c.y} - a.y, double{c.z} - a.z};
  const Vec3 along = frame.orthographic ? frame.forward : a;
  return along.x * (ab[1] * ac[2] - ab[2] * ac[1]) + along.y * (ab[2] * ac[0] - ab[0] * ac[2]) +
         along.z * (ab[0] * ac[1] - ab[1] * ac[0]);
}

/// Whether the triangle with these corners relative to the eye may be visible in an image.
RAYSHEAF_HD inline bool may_show(const PictureView& view, Vec3 a, Vec3 b, Vec3 c,
                                 std::uint8_t flags) {
  const double side = facing(view.frame, a, b, c);
  const bool front = (flags & kMirrored) != 0 ? side > 0 : side < 0;
  const bool faces = front || ((flags & kSingleSided) == 0 && (side < 0 || side > 0));
  return faces && (outside(view.clip, a) & outside(view.clip, b) & outside(view.clip, c)) == 0;
}

}  // namespace raysheaf
