// How the cost of a fan depends on the number of rays.
#pragma once

#include <algorithm>
#include <cmath>

namespace raysheaf {

/// The number of rays for which a fan's costs and its pairs per triangle are stated
/// (`SceneHistory::fan_pairs` and `usual_fan_pairs`).
inline constexpr double kFanRays = 262144;

/// With more rays than triangles, the grid of cells is so fine that triangles overlap more tiles:
/// from 2^18 to 2^22 rays the number of pairs grows by a factor of 1.8 to 3.4 in scenes of 36
/// thousand to a million triangles; predicted are 2.5 to 1.6. Smaller triangles meet one tile, with
/// any number of rays: 0.21 to 0.26 pairs each of ten million, from 2^14 to 2^20 rays.
[[nodiscard]] inline double fan_pair_growth(double rays, double triangles) {
  return std::cbrt(std::max(rays, triangles) / std::max(kFanRays, triangles));
}

}  // namespace raysheaf
