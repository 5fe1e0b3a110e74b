// Whether a ray meets the plane of a triangle outside its interval, in binary64: by a third of the
// work of stage 2 (intersect/triangle_body.h). Most of what stage 1 leaves are rays that start or
// end on the triangle, which this settles.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace raysheaf {

/// A t below `least` or above `most` is outside [t_min, t_max] however it is rounded. A negative t
/// is never rounded to 0.
struct WideInterval {
  double least, most;
  WideInterval(float t_min, float t_max)
      : least(t_min - 0x1p-22 * std::fabs(t_min) - 0x1p-149),
        most(t_max + 0x1p-22 * std::fabs(t_max) + 0x1p-149) {
    if (t_min >= 0 && least < 0) least = 0;
  }
};

/// A ray along the axes of its `RaySetup`: d = d_z (x, y, 1).
struct SlopedRay {
  Vec3 origin;
  float x, y, per_z, t_min, t_max;
};

/// The plane of a triangle, whose corners are along the rays' axes.
struct Plane {
  [[nodiscard]] static double largest(double x, double y, double z) {
    return std::max(std::max(std::fabs(x), std::fabs(y)), std::fabs(z));
  }
  /// u, a little more than which is one rounding to binary32.
  static constexpr double kRounding = 0x1.01p-24;

  double nx, ny, nz;      ///< n
  double det_off, t_off;  ///< how far n . (x, y, 1) may be off, and n . k for each unit of k

  /// Errors are those of `determinants`, with sums of at most 6 products of the largest extent q.
  /// t = n . k (1 / d_z) / (n . (x, y, 1)), where x, y and 1 / d_z have been rounded once, to
  /// binary32: the second sum is off by u (|n_x| + |n_y|) more, and what is above the line by u of
  /// itself.
  Plane(Vec3 a, Vec3 b, Vec3 c) {
    const double ex = double{b.x} - double{a.x}, fx = double{c.x} - double{a.x};
    const double ey = double{b.y} - double{a.y}, fy = double{c.y} - double{a.y};
    const double ez = double{b.z} - double{a.z}, fz = double{c.z} - double{a.z};
    nx = ey * fz - ez * fy, ny = ez * fx - ex * fz, nz = ex * fy - ey * fx;
    const double q = std::max(largest(ex, ey, ez), largest(fx, fy, fz));
    det_off = 0x1p-47 * (q * q) + kRounding * (std::fabs(nx) + std::fabs(ny));
    t_off = 0x1.03p-46 * (q * q);
  }

  /// Whether the ray's line, if it meets the triangle at all, does so surely outside the interval.
  /// `a`: the triangle's first corner. False says nothing.
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
