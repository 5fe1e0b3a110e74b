#include "render/raster/projection.h"

#include <algorithm>
#include <cmath>

namespace raysheaf {
namespace {

using Row = std::array<double, 3>;

Row row(Vec3 v) {
  return {v.x, v.y, v.z};
}
Row cross(const Row& a, const Row& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Row scaled(const Row& a, double s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}

double dot(const Row& a, const Row& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The rows that compute x, y and depth of a point `eye + x right + y up + depth forward`: the dual
/// basis of the camera's axes, which need not be orthogonal.
struct DualBasis {
  Row x, y, depth;
};

DualBasis dual_basis(const CameraFrame& frame) {
  const Row right = row(frame.right), up = row(frame.up), forward = row(frame.forward);
  const Row across = cross(up, forward);
  const double det = dot(right, across);
  return {scaled(across, 1 / det), scaled(cross(forward, right), 1 / det),
          scaled(cross(right, up), 1 / det)};
}

/// Maps depth to clip z and w: z = offset - scale * depth.
struct DepthMap {
  double scale, offset, w_scale, w_offset;
};

DepthMap perspective_depth(double z_near, double z_far) {
  if (std::isinf(z_far)) return {0, z_near, 1, 0};
  const double k = z_near / (z_far - z_near);
  return {k, k * z_far, 1, 0};
}

DepthMap orthographic_depth(double z_near, double z_far) {
  const double k = 1 / (z_far - z_near);
  return {k, k * z_far, 0, 1};
}

}  // namespace

ClipMatrix clip_matrix(const CameraFrame& frame, float farthest) {
  const DualBasis dual = dual_basis(frame);
  const Row x = scaled(dual.x, 1.0 / frame.half_width);
  const Row y = scaled(dual.y, -1.0 / frame.half_height);
  // With z_near 0 every perspective depth would be 0; reversed depth has enough exponents for a
  // tiny value.
  const double z_near = frame.orthographic ? frame.z_near : std::max(frame.z_near, 1e-18f);
  const double beyond = std::max<double>(farthest, z_near) * (1 + 1e-6) + 1e-30;
  const DepthMap map = frame.orthographic
                           ? orthographic_depth(z_near, std::min<double>(frame.z_far, beyond))
                           : perspective_depth(z_near, frame.z_far);

  ClipMatrix m;
  for (std::size_t c = 0; c < 3; ++c) {
    m[4 * c + 0] = static_cast<float>(x[c]);
    m[4 * c + 1] = static_cast<float>(y[c]);
    m[4 * c + 2] = static_cast<float>(-map.scale * dual.depth[c]);
    m[4 * c + 3] = static_cast<float>(map.w_scale * dual.depth[c]);
  }
  m[12] = m[13] = 0;
  m[14] = static_cast<float>(map.offset);
  m[15] = static_cast<float>(map.w_offset);
  return m;
}

float farthest_depth(const CameraFrame& frame, const Box& box) {
  const DualBasis dual = dual_basis(frame);
  const Row eye = row(frame.eye);
  double farthest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Row p = {corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                   corner & 4 ? box.max.z : box.min.z};
    farthest = std::max(farthest, dot(dual.depth, {p[0] - eye[0], p[1] - eye[1], p[2] - eye[2]}));
  }
  return static_cast<float>(farthest);
}

}  // namespace raysheaf
