// A bundle of rays and its bounding volume, as lines in the world.
#pragma once

#include <cstdint>
#include <vector>

#include "raysheaf/lab.h"

namespace raysheaf::viewer {

struct WorldLine {
  enum class Kind : std::uint8_t { kRay, kAskedRay, kHull, kCone };
  Vec3 from, to;
  Kind kind = Kind::kRay;
  std::uint32_t level = 0;  ///< of a bound: 0 belongs to the rays themselves
};

/// `reach` is the length of infinite lines. Only some of many rays are drawn.
[[nodiscard]] std::vector<WorldLine> bundle_lines(const RayBundle& bundle, float reach);

}  // namespace raysheaf::viewer
