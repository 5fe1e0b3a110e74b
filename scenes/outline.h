// Plane lines: their normals, smooth where they bend little, and a few common ones.
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

/// The mean direction of two unit normals, or `own` where they are more than 40 degrees apart.
[[nodiscard]] Vec2 blended_normal(Vec2 own, Vec2 neighbour);

/// How far along the line each point is; one more entry for the way back where it is closed.
[[nodiscard]] std::vector<float> distances(std::span<const Vec2> points, bool closed);

/// Counter-clockwise about the origin.
[[nodiscard]] std::vector<Vec2> circle(float radius, int sides);
[[nodiscard]] std::vector<Vec2> rounded_rectangle(float width, float height, float radius,
                                                  int steps);

}  // namespace raysheaf::builtin
