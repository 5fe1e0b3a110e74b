// Plane polylines: their normals, smooth at small angles, and a few common ones.
#pragma once

#include <span>
#include <vector>

#include "raysheaf/types.h"

namespace raysheaf::builtin {

/// The normals at a line's two ends.
struct LineNormals {
  Vec2 first, second;
};

/// For each line of a polygon the unit normals to its right; ends that meet at less than 40 degrees
/// share one.
[[nodiscard]] std::vector<LineNormals> line_normals(std::span<const Vec2> points, bool closed);

/// The mean direction of two unit normals, or `own` if they are more than 40 degrees apart.
[[nodiscard]] Vec2 blended_normal(Vec2 own, Vec2 neighbour);

/// Each point's distance along the polyline; one more entry for the closing line of a closed one.
[[nodiscard]] std::vector<float> distances(std::span<const Vec2> points, bool closed);

/// Counter-clockwise around the origin.
[[nodiscard]] std::vector<Vec2> circle(float radius, int sides);
[[nodiscard]] std::vector<Vec2> rounded_rectangle(float width, float height, float radius,
                                                  int steps);

}  // namespace raysheaf::builtin
