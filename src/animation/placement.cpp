#include "animation/placement.h"

namespace raysheaf {
namespace {

/// The columns of the rotation by the quaternion x, y, z, w, of any length.
Placement rotated(const std::array<double, 4>& q) {
  const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double x = q[0] / n, y = q[1] / n, z = q[2] / n, w = q[3] / n;
  Placement result;
  result.columns[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)};
  result.columns[1] = {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)};
  result.columns[2] = {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)};
  return result;
}

}  // namespace

Placement local_placement(const RigNode& node) {
  if (node.matrix) {
    Placement result;
    const auto& m = *node.matrix;
    for (std::size_t c = 0; c < 4; ++c) result.columns[c] = {m[0][c], m[1][c], m[2][c]};
    return result;
  }
  Placement result = rotated(node.rotation);
  for (std::size_t c = 0; c < 3; ++c) result.columns[c] = result.columns[c] * node.scale[c];
  result.columns[3] = {node.translation[0], node.translation[1], node.translation[2]};
  return result;
}

Affine camera_frame(const Placement& to_world) {
  const Double3 z = normalized(to_world.columns[2], {0, 0, 1});
  const Double3 up = to_world.columns[1] - z * dot(z, to_world.columns[1]);
  const Double3 spare = std::fabs(z.y) < 0.9 ? Double3{0, 1, 0} : Double3{1, 0, 0};
  const Double3 y = normalized(up, normalized(spare - z * dot(z, spare), {0, 1, 0}));
  Placement frame;
  frame.columns = {cross(y, z), y, z, to_world.columns[3]};
  return rounded(frame);
}

Vec3 light_direction(const Placement& to_world) {
  return rounded(normalized(to_world.columns[2] * -1, {0, 0, -1}));
}

Vec3 light_right(const Placement& to_world) {
  const Double3 z = normalized(to_world.columns[2], {0, 0, 1});
  const Double3 x = to_world.columns[0] - z * dot(z, to_world.columns[0]);
  const Double3 spare = std::fabs(z.x) < 0.9 ? Double3{1, 0, 0} : Double3{0, 1, 0};
  return rounded(normalized(x, normalized(spare - z * dot(z, spare), {1, 0, 0})));
}

}  // namespace raysheaf
