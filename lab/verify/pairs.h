// Pairs of a ray and a triangle that are hard to answer correctly, in families.
#pragma once

#include <array>
#include <span>

#include "lab/verify/random.h"
#include "raysheaf/types.h"

namespace raysheaf::checks {

/// The ray's interval is [0, infinity]; all numbers are finite, and the direction is not zero.
struct RayAndTriangle {
  Ray ray;
  std::array<Vec3, 3> corners;
};

struct PairFamily {
  const char* name;
  RayAndTriangle (*make)(Random*);
};

/// The first family has ordinary pairs: triangles seen at more than 6 degrees, neither small nor
/// thin, from a distance of a few of their sizes. The others are adversarial: they aim at corners,
/// edges and planes, with coordinates of all magnitudes.
[[nodiscard]] std::span<const PairFamily> pair_families();

}  // namespace raysheaf::checks
