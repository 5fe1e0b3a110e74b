// Meshes whose vertices are whole numbers, and rays that meet their corners, edges and insides
// exactly.
#pragma once

#include <vector>

#include "lab/verify/soup.h"

namespace raysheaf::checks {

/// A grid, one with T-junctions, a fan, boxes in boxes, a height field, or triangles at random,
/// flat ones without area among them: some tens to `most_triangles` of them, all vertices being
/// multiples of 4 times a power of two, and moved by such a number.
[[nodiscard]] Soup make_whole_meshes(std::uint32_t most_triangles, Random* random);

/// Rays through corners, edges and insides, exactly: quarter points after a whole number of steps.
/// A third of them miss that point by fractions or by a rounding. Some lie in planes, start on
/// triangles, and have intervals that end or begin at a step. `one_origin`: all start there.
[[nodiscard]] std::vector<Ray> make_whole_rays(const Soup& soup, std::size_t count, bool one_origin,
                                               Random* random);

}  // namespace raysheaf::checks
