// How the cost of a fan depends on the number of rays.
#pragma once

#include <cmath>

namespace raysheaf {

/// The number of rays for which a fan's costs and its pairs per triangle are stated
/// (`SceneHistory::fan_pairs` and `usual_fan_pairs`).
inline constexpr double kFanRays = 262144;

/// With more rays, the grid of cells is finer, and each triangle overlaps more tiles. From 2^18 to
/// 2^22 rays the number of pairs grows by a factor of 1.8 to 3.4, in scenes of 36 thousand to a
/// million triangles; the cube root predicts 2.5.
[[nodiscard]] inline double fan_pair_growth(double rays) {
  return std::cbrt(rays / kFanRays);
}

}  // namespace raysheaf
