// Answers about points by other arithmetic than the library's: distances with 113 bits, sides and
// crossings by the determinants of intersect/exact.h.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "lab/verify/soup.h"
#include "nearest/point.h"
#include "raysheaf/points.h"

namespace raysheaf::checks {

/// From a point to a triangle, with an error far below that of `distance_to_triangle`.
[[nodiscard]] double wide_distance(Point point, Point a, Point b, Point c);
[[nodiscard]] double longest_edge(Point a, Point b, Point c);

/// Empty if `found`, whose `geom_id` is the number of a mesh of `soup`, is a nearest point to
/// `point` of the meshes that are `seen`, and on the correct side; otherwise a sentence.
/// O(triangles).
[[nodiscard]] std::string fault_of(Point point, const ClosestPoint& found, const Soup& soup,
                                   std::span<const std::uint8_t> seen);

/// Whether the point is inside by `rule`, from six rays along the axes; nothing if one of them
/// meets an edge or a corner, or if the point is in a triangle. O(triangles).
[[nodiscard]] std::optional<bool> inside_exactly(Vec3 point, const Soup& soup,
                                                 std::span<const std::uint8_t> seen,
                                                 InsideRule rule);

}  // namespace raysheaf::checks
