// On which side of lines and planes a point lies, exactly: binary64 settles nearly all, expansions
// the rest (base/exact_sum_body.h).
//
// Corners are floats, whose products of two are exact doubles; coordinates of points are doubles
// from 1e-60 to 1e18, or 0. All determinants are sums of products of two doubles that keep their
// last bits: multiples of 2^-700, below 2^200.
#pragma once

#include <cmath>

#include "base/exact_sum_body.h"
#include "nearest/point.h"

namespace raysheaf {

RAYSHEAF_HD inline int sign_of(double x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

/// `side_of_line` where binary64 does not settle it.
RAYSHEAF_HD_CALLED inline int exact_side_of_line(double px, double py, double ax, double ay,
                                                 double bx, double by) {
  ExactSum sum;
  sum.add(ax * by);
  sum.add(-(ay * bx));
  sum.add_product(px, ay);
  sum.add_product(-px, by);
  sum.add_product(py, bx);
  sum.add_product(-py, ax);
  return sum.sign();
}

/// The sign of (ax - px)(by - py) - (ay - py)(bx - px): whether p, a, b run counter-clockwise.
RAYSHEAF_HD inline int side_of_line(double px, double py, double ax, double ay, double bx,
                                    double by) {
  const double left = (ax - px) * (by - py), right = (ay - py) * (bx - px);
  const double value = left - right;
  // 3 + 16 eps roundings of 2^-53.
  if (std::fabs(value) > 0x1.8000001p-52 * (std::fabs(left) + std::fabs(right)))
    return sign_of(value);
  return exact_side_of_line(px, py, ax, ay, bx, by);
}

/// One component of (b - a) x (c - a), of the axes y and z: its sign.
RAYSHEAF_HD inline int sign_of_area(double ay, double az, double by, double bz, double cy,
                                    double cz) {
  return side_of_line(ay, az, by, bz, cy, cz);
}

/// `side_of_plane` where binary64 does not settle it.
RAYSHEAF_HD_CALLED inline int exact_side_of_plane(Point p, Point a, Point b, Point c) {
  ExactSum sum;
  const auto add_minor = [&](double y, double z, double factor) {  // factor * y * z
    sum.add_product(y * z, factor);
  };
  const Point* const corner[3] = {&a, &b, &c};
  for (int i = 0; i < 3; ++i) {  // of the plane's normal, a x b + b x c + c x a, with p
    const Point &s = *corner[i], &t = *corner[(i + 1) % 3];
    add_minor(s.y, t.z, p.x);
    add_minor(-s.z, t.y, p.x);
    add_minor(s.z, t.x, p.y);
    add_minor(-s.x, t.z, p.y);
    add_minor(s.x, t.y, p.z);
    add_minor(-s.y, t.x, p.z);
  }
  add_minor(b.y, c.z, -a.x);  // a . (b x c)
  add_minor(-b.z, c.y, -a.x);
  add_minor(b.z, c.x, -a.y);
  add_minor(-b.x, c.z, -a.y);
  add_minor(b.x, c.y, -a.z);
  add_minor(-b.y, c.x, -a.z);
  return sum.sign();
}

/// The sign of (p - a) . ((b - a) x (c - a)): 1 where the corners run counter-clockwise as seen
/// from p, 0 in their plane.
RAYSHEAF_HD inline int side_of_plane(Point p, Point a, Point b, Point c) {
  const Point u = a - p, v = b - p, w = c - p;
  const double vw = v.x * w.y, wv = w.x * v.y, wu = w.x * u.y, uw = u.x * w.y;
  const double uv = u.x * v.y, vu = v.x * u.y;
  const double value = u.z * (vw - wv) + v.z * (wu - uw) + w.z * (uv - vu);
  const double size = (std::fabs(vw) + std::fabs(wv)) * std::fabs(u.z) +
                      (std::fabs(wu) + std::fabs(uw)) * std::fabs(v.z) +
                      (std::fabs(uv) + std::fabs(vu)) * std::fabs(w.z);
  // 7 + 56 eps roundings of 2^-53.
  if (std::fabs(value) > 0x1.c000001p-51 * size) return -sign_of(value);
  return exact_side_of_plane(p, a, b, c);
}

}  // namespace raysheaf
