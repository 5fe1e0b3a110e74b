// The one distance between a point and a triangle: brute force, every SIMD target and every tree
// have its bits.
//
// It is the least of four: to the three edges, and to the plane where the foot of the perpendicular
// lies within. With a, b, c the corners as seen from the point, p - a and so on:
//
//   edge ab    w = (p - a) + (p - b),  h = b - a,  tau = w . h / h . h in [-1, 1]
//              r = (w - tau h) / 2, from the nearest point of the edge to p; at tau = 1 it is p - b
//   plane      n = h x k,  A = k x n / n . n,  B = n x h / n . n,     h = b - a, k = c - a
//              u = (p - a) . A,  v = (p - a) . B,  r = (p - a) - u h - v k
//              and once more from r: it makes the error of u and v one of the distance
//
// Exchanging an edge's ends changes the sign of h and of tau and nothing else, so that triangles
// which share the edge have the same bits. Each component of r is clamped to where the triangle is:
// between the least and the largest of p - a, p - b, p - c. Rounding keeps the order of numbers, so
// r . r is nowhere below the same sum of the distances to a box that holds the triangle, computed
// in binary64 in the same order: boxes bound what is computed, with no error term.
//
// An interior point comes from weights within the triangle: whatever their error, it is a point of
// the triangle, and never farther than the edges are. The error of distances (raysheaf/points.h) is
// that of r: a few roundings of w, h and k.
#pragma once

#include <cmath>
#include <cstdint>

#include "nearest/point.h"

namespace raysheaf {

/// The squared distance, and where the nearest point is: the weights of the second and third
/// corner.
struct TriangleDistance {
  double squared = 0;
  double u = 0, v = 0;
};

RAYSHEAF_HD inline double lesser_of(double a, double b) {
  return a < b ? a : b;
}
RAYSHEAF_HD inline double larger_of(double a, double b) {
  return a > b ? a : b;
}
RAYSHEAF_HD inline double clamped(double x, double low, double high) {
  return lesser_of(larger_of(x, low), high);
}

/// From the nearest point of the edge, whose ends are `to_a` and `to_b` before `p`, to `p`;
/// `h` = b - a. `tau` is -1 at a and 1 at b.
RAYSHEAF_HD inline Point from_edge(Point to_a, Point to_b, Point h, double* tau) {
  const Point w = to_a + to_b;
  const double length = dot(h, h);
  const double t = dot(w, h) / (length > 0 ? length : 1);
  *tau = clamped(t, -1, 1);
  if (t >= 1) return to_b;
  if (t <= -1) return to_a;
  const auto between = [&](double sum, double slope, double a, double b) {
    return clamped((sum - t * slope) * 0.5, lesser_of(a, b), larger_of(a, b));
  };
  return {between(w.x, h.x, to_a.x, to_b.x), between(w.y, h.y, to_a.y, to_b.y),
          between(w.z, h.z, to_a.z, to_b.z)};
}

RAYSHEAF_HD inline TriangleDistance distance_to_triangle(Point p, Point a, Point b, Point c) {
  const Point to_a = p - a, to_b = p - b, to_c = p - c;
  const Point h = b - a, k = c - a, m = c - b;
  double tau_ab, tau_bc, tau_ac;
  const Point r_ab = from_edge(to_a, to_b, h, &tau_ab);
  const Point r_bc = from_edge(to_b, to_c, m, &tau_bc);
  const Point r_ac = from_edge(to_a, to_c, k, &tau_ac);
  TriangleDistance best{dot(r_ab, r_ab), 0.5 + 0.5 * tau_ab, 0};
  const double bc = dot(r_bc, r_bc), ac = dot(r_ac, r_ac);
  if (bc < best.squared) best = {bc, 0.5 - 0.5 * tau_bc, 0.5 + 0.5 * tau_bc};
  if (ac < best.squared) best = {ac, 0, 0.5 + 0.5 * tau_ac};

  const Point n = cross(h, k);
  const double nn = dot(n, n);
  const double per = 1 / (nn > 0 ? nn : 1);
  const Point of_u = per * cross(k, n), of_v = per * cross(n, h);
  double u = dot(to_a, of_u), v = dot(to_a, of_v);
  const auto rest = [&] {
    return Point{(to_a.x - u * h.x) - v * k.x, (to_a.y - u * h.y) - v * k.y,
                 (to_a.z - u * h.z) - v * k.z};
  };
  Point r = rest();
  u = u + dot(r, of_u);
  v = v + dot(r, of_v);
  if (!(u > 0 && v > 0 && u + v < 1 && nn > 0)) return best;
  r = rest();
  const auto within = [](double x, double at_a, double at_b, double at_c) {
    return clamped(x, lesser_of(lesser_of(at_a, at_b), at_c),
                   larger_of(larger_of(at_a, at_b), at_c));
  };
  r = {within(r.x, to_a.x, to_b.x, to_c.x), within(r.y, to_a.y, to_b.y, to_c.y),
       within(r.z, to_a.z, to_b.z, to_c.z)};
  const double squared = dot(r, r);
  if (squared < best.squared) best = {squared, u, v};
  return best;
}

/// The point of the triangle that has these weights; corners where they say so, bit for bit.
RAYSHEAF_HD inline Point point_of_weights(double u, double v, Point a, Point b, Point c) {
  if (u == 1) return b;
  if (v == 1) return c;
  const auto at = [&](double x, double y, double z) {
    return clamped(x + u * (y - x) + v * (z - x), lesser_of(lesser_of(x, y), z),
                   larger_of(larger_of(x, y), z));
  };
  return {at(a.x, b.x, c.x), at(a.y, b.y, c.y), at(a.z, b.z, c.z)};
}

/// How far away triangles may be.
struct NearestLimit {
  double distance = 0, most_squared = 0;
  float reach = 0;  ///< for squared distances to boxes in binary32

  NearestLimit() = default;
  RAYSHEAF_HD explicit NearestLimit(double radius) { set(radius); }
  RAYSHEAF_HD void set(double to) {
    distance = to;
    // A square that exceeds this has a root above the distance.
    most_squared = to * to * (1 + 0x1p-50);
    // Conversion to float rounds by at most 2^-24 of it, or below 2^-126 by less than 2^-149.
    reach = static_cast<float>(most_squared) * (1 + 0x1p-18f) + 0x1p-120f;
  }
};

}  // namespace raysheaf
