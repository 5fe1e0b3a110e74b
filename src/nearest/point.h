// Points of queries, as doubles, and corners of triangles as such.
#pragma once

#include <limits>

#include "base/host_device.h"
#include "raysheaf/types.h"

namespace raysheaf {

struct Point {
  double x = 0, y = 0, z = 0;
};

RAYSHEAF_HD inline Point to_point(Vec3 a) {
  return {a.x, a.y, a.z};
}
RAYSHEAF_HD inline Point operator-(Point a, Point b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
RAYSHEAF_HD inline Point operator+(Point a, Point b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
RAYSHEAF_HD inline Point operator*(double s, Point a) {
  return {s * a.x, s * a.y, s * a.z};
}
RAYSHEAF_HD inline double dot(Point a, Point b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
RAYSHEAF_HD inline Point cross(Point a, Point b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
RAYSHEAF_HD inline double component(Point a, int axis) {
  return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}

/// A point, and how far away what it asks for may be.
struct QueryPoint {
  Point at;
  double radius = std::numeric_limits<double>::infinity();
};

/// Which points are answered, and what counts as 0: so exact predicates neither over- nor
/// underflow.
inline constexpr double kFarthestPoint = 1e18, kLeastCoordinate = 1e-60;

}  // namespace raysheaf
