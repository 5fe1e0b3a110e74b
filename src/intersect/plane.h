// Decides in binary64 whether a ray intersects the plane of a triangle outside the ray's interval,
// with a third of the work of stage 2 (intersect/triangle_body.h). Most rays that stage 1 does not
// decide start or end on the triangle; this test rejects them.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace raysheaf {

/// A t below `least` or above `most` is outside [t_min, t_max] as rounded: its error is below
/// 2^-23. A negative t is never rounded to 0.
struct WideInterval {
  double least, most;
  WideInterval(float t_min, float t_max)
      : least(t_min - 0x1p-23 * std::fabs(t_min) - 0x1p-149),
        most(t_max + 0x1p-23 * std::fabs(t_max) + 0x1p-149) {
    if (t_min >= 0 && least < 0) least = 0;
  }
};

/// A ray along the axes of its `RaySetup`: d = d_z (x, y, 1).
struct SlopedRay {
  Vec3 origin;
  float x, y, per_z, t_min, t_max;
};

/// The plane of a triangle whose corners are given in the rays' axes.
struct Plane {
  [[nodiscard]] static double largest(double x, double y, double z) {
    return std::max(std::max(std::fabs(x), std::fabs(y)), std::fabs(z));
  }
  /// Slightly more than u, the error of one rounding to binary32.
  static constexpr double kRounding = 0x1.01p-24;

  double nx, ny, nz;      ///< n
  double det_off, t_off;  ///< error bounds of n . (x, y, 1), and of n . k per unit of k

  /// The errors are those of `determinants`, with sums of at most 6 products of the largest extent
  /// q. t is n . k (1 / d_z) / (n . (x, y, 1)), where x, y and 1 / d_z have been rounded once, to
  /// binary32: the second sum has an additional error of u (|n_x| + |n_y|), and the numerator one
  /// of u times itself.
  Plane(Vec3 a, Vec3 b, Vec3 c) {
    const double ex = double{b.x} - double{a.x}, fx = double{c.x} - double{a.x};
    const double ey = double{b.y} - double{a.y}, fy = double{c.y} - double{a.y};
    const double ez = double{b.z} - double{a.z}, fz = double{c.z} - double{a.z};
    nx = ey * fz - ez * fy, ny = ez * fx - ex * fz, nz = ex * fy - ey * fx;
    const double q = std::max(largest(ex, ey, ez), largest(fx, fy, fz));
    det_off = 0x1p-47 * (q * q) + kRounding * (std::fabs(nx) + std::fabs(ny));
    t_off = 0x1.03p-46 * (q * q);
  }

  /// Whether the ray's line, if it intersects the triangle at all, certainly does so outside the
  /// interval. `a`: the triangle's first corner. False means undecided.
  [[nodiscard]] bool surely_beyond(const SlopedRay& ray, Vec3 a) const {
    const double kx = double{a.x} - double{ray.origin.x}, ky = double{a.y} - double{ray.origin.y},
                 kz = double{a.z} - double{ray.origin.z};
    const double det = nx * double{ray.x} + ny * double{ray.y} + nz;
    const double size = std::fabs(det), per_z = double{ray.per_z}, per_size = std::fabs(per_z);
    const double over = (nx * kx + ny * ky + nz * kz) * per_z;
    const double along = det < 0 ? -over : over;
    const double off = t_off * per_size * largest(kx, ky, kz) + kRounding * std::fabs(over);
    const auto [least, most] = WideInterval(ray.t_min, ray.t_max);
    return size > det_off && per_size >= 0x1p-100 &&
           (along + off < least * size - std::fabs(least) * det_off ||
            along - off > most * size + std::fabs(most) * det_off);
  }
};

}  // namespace raysheaf
