// How the number of rays moves what a fan costs.
#pragma once

#include <cmath>

namespace raysheaf {

/// The number of rays that a fan's costs are stated for, and its pairs a triangle
/// (`SceneHistory::fan_pairs` and `usual_fan_pairs`).
inline constexpr double kFanRays = 262144;

/// More rays have a finer grid of cells, and each triangle meets more of its tiles. From 2^18 to
/// 2^22 rays the pairs grow by 1.8 to 3.4 times, in scenes of 36 thousand to a million triangles;
/// the cube root says 2.5.
[[nodiscard]] inline double fan_pair_growth(double rays) {
  return std::cbrt(rays / kFanRays);
}

}  // namespace raysheaf
