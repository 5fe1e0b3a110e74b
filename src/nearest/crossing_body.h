// Whether a ray along an axis crosses a triangle, as an integer that no rounding touches.
//
// The point counts as moved by (e, e^2, e^3) for an e smaller than all that matters (H.
// Edelsbrunner and E. Muecke, "Simulation of Simplicity", 1990). So its ray meets no edge and no
// corner, no triangle holds it, and where triangles share an edge it crosses exactly one of those
// that lie to either side: crossings of a closed surface add up, whatever the ray meets.
#pragma once

#include <cstdint>

#include "nearest/exact_sign_body.h"

namespace raysheaf {

/// The six directions along the axes: +x, +y, +z, -x, -y, -z.
inline constexpr int kAxisRays = 6;

/// `side_of_line` of the moved point: 0 only where a and b are one point of the projection.
RAYSHEAF_HD inline int side_of_moved(double px, double py, double ax, double ay, double bx,
                                     double by) {
  const int side = side_of_line(px, py, ax, ay, bx, by);
  if (side != 0) return side;
  // Its derivatives by px and by py, which are exact signs of differences.
  if (ay != by) return ay > by ? 1 : -1;
  if (ax != bx) return bx > ax ? 1 : -1;
  return 0;
}

/// 1 where the ray from p leaves through the front of the triangle, -1 where through its back, 0
/// where it does not cross it. `y` and `z` are the axes that follow `axis` in cyclic order, in the
/// order of the axes for what is moved.
RAYSHEAF_HD inline int crossing(Point p, Point a, Point b, Point c, int ray) {
  const int axis = ray % 3, i = (axis + 1) % 3, k = (axis + 2) % 3;
  // For the y axis the other axes come as z, x: they are exchanged, and every sign changes.
  const int first = i < k ? i : k, second = i < k ? k : i, turn = i < k ? 1 : -1;
  const double px = component(p, first), py = component(p, second);
  const double ax = component(a, first), ay = component(a, second);
  const double bx = component(b, first), by = component(b, second);
  const int side = side_of_moved(px, py, ax, ay, bx, by);
  if (side == 0) return 0;
  const double cx = component(c, first), cy = component(c, second);
  if (side_of_moved(px, py, bx, by, cx, cy) != side) return 0;
  if (side_of_moved(px, py, cx, cy, ax, ay) != side) return 0;
  const int facing = turn * side;         // the sign of the normal along the axis
  int above = side_of_plane(p, a, b, c);  // 1: the point is before the front
  if (above == 0) above = sign_of_area(a.y, a.z, b.y, b.z, c.y, c.z);
  if (above == 0) above = sign_of_area(a.z, a.x, b.z, b.x, c.z, c.x);
  if (above == 0) above = sign_of_area(a.x, a.y, b.x, b.y, c.x, c.y);
  const int way = ray < 3 ? 1 : -1;
  // The ray goes towards the plane where it goes against the side that the point is on.
  return above * facing * way < 0 ? facing * way : 0;
}

/// How often a surface winds around a point, by one ray, and how often that ray crosses it.
struct Crossings {
  std::int64_t winding = 0, number = 0;

  RAYSHEAF_HD void add(int crossed) {
    winding += crossed;
    number += crossed != 0 ? 1 : 0;
  }
};

}  // namespace raysheaf
