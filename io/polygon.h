// Polygons into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "raysheaf/types.h"

namespace raysheaf::io {

/// Cuts the polygon whose corners stand at `points` into `points.size() - 2` triangles of corner
/// numbers, in the winding of the polygon: a fan from the first corner where the polygon is convex
/// or has no plane, ears where it is concave. It may touch itself, as where holes hang on its
/// border by an edge there and back. Nothing below three corners. Time is O(n log n) for polygons
/// as files have them and bounded by O(n) steps of 4096 for all; those that need more, or cross
/// themselves, are cut anyhow.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangulate(
    const std::vector<Vec3>& points);

}  // namespace raysheaf::io
