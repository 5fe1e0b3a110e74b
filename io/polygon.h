// Polygons into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "raysheaf/types.h"

namespace raysheaf::io {

/// Concave polygons of more corners than this are cut as fans: clipping ears takes quadratic time.
inline constexpr std::size_t kMaxEarCorners = 256;

/// Cuts the polygon whose corners stand at `points` into `points.size() - 2` triangles of corner
/// numbers, in the winding of the polygon: a fan from the first corner where the polygon is convex
/// or has no plane, ears where it is concave. Nothing below three corners.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangulate(
    const std::vector<Vec3>& points);

}  // namespace raysheaf::io
