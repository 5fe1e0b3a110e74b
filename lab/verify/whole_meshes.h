// Meshes whose vertices are integers, and rays that hit their corners, edges and inner points
// exactly.
#pragma once

#include <vector>

#include "lab/verify/soup.h"

namespace raysheaf::checks {

/// A grid, one with T-junctions, a fan, nested boxes, a height field, or random triangles, some of
/// them without area: from some tens to `most_triangles` triangles. All vertices are multiples of 4
/// times a power of two, moved by such a number.
[[nodiscard]] Soup make_whole_meshes(std::uint32_t most_triangles, Random* random);

/// Rays that hit corners, edges and inner points exactly: quarter points after an integer number of
/// steps. A third of them miss that point by fractions or by a rounding. Some lie in planes, start
/// on triangles, or have intervals that end or begin at a step. `one_origin`: all start there.
[[nodiscard]] std::vector<Ray> make_whole_rays(const Soup& soup, std::size_t count, bool one_origin,
                                               Random* random);

}  // namespace raysheaf::checks
