// Faces with any number of corners.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "raysheaf/types.h"

namespace raysheaf::io {

/// Cuts the polygon with corners at `points` into `points.size() - 2` triangles of corner indices
/// with the polygon's winding: a fan from the first corner if the polygon is convex or has no
/// plane, ear clipping if it is concave. It may touch itself, as with holes that are connected to
/// the border by a pair of coincident edges. Fewer than three corners give no triangles. The time
/// is O(n log n) for polygons as they occur in files, and bounded by 4096 tests per corner for all.
/// Polygons that need more, or cross themselves, are still cut, into triangles that may overlap.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> triangulate(
    const std::vector<Vec3>& points);

/// Adds the warning that `count` faces (none if 0) are left out because they use a vertex that is
/// not finite. Throws if no triangle is left.
void warn_of_odd_faces(std::uint64_t count, bool any_left, std::vector<std::string>& warnings);

}  // namespace raysheaf::io
