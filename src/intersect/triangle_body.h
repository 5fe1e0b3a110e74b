// The ray-triangle test. Every method and device gives its answers, bit for bit.
//
// Exact arithmetic on the given floats defines whether a ray o + t d hits the triangle a, b, c:
// edges and corners belong to the triangle; a ray in its plane misses it; a triangle without area
// is never hit. t, u and v are rounded once, from values that are accurate to 2^-27, and the
// rounded t of a hit is in [t_min, t_max]. Consequently no ray passes between triangles that share
// an edge or a corner, and all methods report the same triangle even if only one ray in a million
// distinguishes two triangles.
//
// With e = b - a, f = c - a, n = e x f, k = a - o, the test needs only signs and quotients of
// determinants:
//
//        c            det = n . d      t = n . k / det
//       / \           u = (k x d) . f / det      the weight of b
//      / o \          v = -(k x d) . e / det     the weight of c
//     a --- b         w = 1 - u - v              the weight of a
//
// There are three stages, each for the cases that the previous one does not decide:
//
// 1. Binary32 rejects (`surely_misses`): nearly all tests end here, and most of the rest are hits.
// 2. Binary64 decides (`determinants`, with error bounds from the sums of the products' magnitudes;
//    J. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//    Predicates", 1997). Differences, products and sums of floats neither overflow nor underflow
//    there: 2^-447 to 2^390.
// 3. Integers (intersect/wide_body.h): rays through edges and corners, and grazing ones.
//
// Stage 1. Corners are moved to the origin and sheared, so that the ray points along +z (S. Woop,
// C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013); for a hit, the
// edge functions U = C x B, V = A x C, W = B x A (z of the cross products) agree in sign. Let u =
// 2^-24, q be the largest extent of the triangle along an axis, Z >= |z| of all corners, and S >=
// |x|, |y| of all sheared corners. Slopes are at most 1. The error of a sheared coordinate is u (S
// + Z) in the difference to the origin, 3 u Z in the product (slope, z, rounding), u S in the last
// difference: E <= u (2 S + 6 Z), rounded up. The error of an edge function is 4 S E + 2 E^2 + 4 u
// (S + E)^2. If the ray hits the triangle, the exact S <= 2 q, because the distances between all
// points of the sheared triangle, including 0, are at most that. With r >= 2 q and Y = |z of a
// corner| + r, so that 4 q + 6 Z <= 6 Y - 2 q:
//
//    the error is at most 48 u q Y + 256 u^2 Y^2 < e = Y (1024 u^2 Y + 32 u r)
//
// Therefore the ray misses if one edge function is beyond e and another below -e, for any triangle.
// Conversely, if all are beyond e, or all below -e, the ray hits: the signs are exactly those of
// the computed corners, because rounding is monotonic and nothing is fused (decision 1). These
// corners surround the ray, S <= 2 q + 3 E, and the error is below 48 u q Y + 700 u^2 Y^2 < e.
// `reach_of` is infinite if products of differences could underflow or overflow; then e is not
// finite, and this stage decides nothing. The same holds from Y = 2^83 on.
//
// For a hit of stage 1, the computed t is a mean of the corners' depths with weights that have an
// error of e each. Along z, its error is at most 3 e q / |det| for the weights, and 12 u Y for
// roundings (`depth_error`). SIMD kernels keep that interval for each ray and need stage 2 only if
// two intervals overlap; t, u and v are computed once, for the final hit.
#pragma once

#include <cmath>
#include <limits>

#include "base/host_device.h"
#include "base/vec.h"
#include "intersect/wide_body.h"

namespace raysheaf {

/// Data of a ray for all its tests: its dominant axis (z), the other two in the order that
/// preserves the winding, and the shear.
struct RaySetup {
  Vec3 origin, direction;
  float shear_x, shear_y, shear_z;
  float t_min, t_max;
  int axis_x, axis_y, axis_z;
};

struct TriangleHit {
  float t, u, v;
  bool front;  ///< hit from the side from which the corners are counter-clockwise
};

/// Error of edge functions: coefficients of Y^2, and of Y times the reach.
inline constexpr float kErrorOfSquare = 0x1p-38f, kErrorOfReach = 0x1p-19f;
/// Error of depths: coefficients of the edge functions' error times the reach, and of Y.
inline constexpr float kErrorOfWeights = 1.6f, kErrorOfDepth = 0x1p-20f;
/// Outside these limits, edge functions, and distances times them, may have lost bits to underflow
/// or overflow.
inline constexpr float kSmallDeterminant = 0x1p-60f, kLargeDeterminant = 0x1p120f;
inline constexpr float kSmallDistance = 0x1p-100f;
/// Intervals of t up to this width may have lost bits to underflow.
inline constexpr float kSmallInterval = 0x1p-140f;

RAYSHEAF_HD inline RaySetup make_ray_setup(const Ray& ray) {
  const Vec3 d = ray.direction, m = abs(d);
  const int z = m.x > m.y ? (m.x > m.z ? 0 : 2) : (m.y > m.z ? 1 : 2);
  int x = z == 2 ? 0 : z + 1;
  int y = x == 2 ? 0 : x + 1;
  const float along = component(d, z);
  if (along < 0) {
    const int other = x;
    x = y;
    y = other;
  }
  return {ray.origin,
          d,
          component(d, x) / along,
          component(d, y) / along,
          1.0f / along,
          ray.t_min,
          ray.t_max,
          x,
          y,
          z};
}

inline constexpr float kLeastReachExtent = 0x1p-60f, kMostReachExtent = 0x1p60f;
inline constexpr float kReachOfExtent = 2 + 8 * 0x1p-24f;

/// r >= 2 q, or infinity. `extent` is the computed q.
RAYSHEAF_HD inline float reach_of_extent(float extent) {
  return extent >= kLeastReachExtent && extent <= kMostReachExtent
             ? extent * kReachOfExtent
             : std::numeric_limits<float>::infinity();
}
RAYSHEAF_HD inline float reach_of(Vec3 a, Vec3 b, Vec3 c) {
  return reach_of_extent(max_component(max(max(a, b), c) - min(min(a, b), c)));
}

/// The rounded edge functions, the depths of the corners, and an error bound of the edge functions.
struct Edges {
  float u, v, w;
  float az, bz, cz;
  float reach, size, error;

  /// Stage 1. False means undecided.
  [[nodiscard]] RAYSHEAF_HD bool surely_miss() const {
    return (u > error || v > error || w > error) && (u < -error || v < -error || w < -error);
  }
  /// The same for hits of the ray's line.
  [[nodiscard]] RAYSHEAF_HD bool surely_hit() const {
    return (u > error && v > error && w > error) || (u < -error && v < -error && w < -error);
  }
};

RAYSHEAF_HD inline Edges edges_of(const RaySetup& ray, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 oa = a - ray.origin, ob = b - ray.origin, oc = c - ray.origin;
  const float az = component(oa, ray.axis_z);
  const float bz = component(ob, ray.axis_z);
  const float cz = component(oc, ray.axis_z);
  const float ax = component(oa, ray.axis_x) - ray.shear_x * az;
  const float ay = component(oa, ray.axis_y) - ray.shear_y * az;
  const float bx = component(ob, ray.axis_x) - ray.shear_x * bz;
  const float by = component(ob, ray.axis_y) - ray.shear_y * bz;
  const float cx = component(oc, ray.axis_x) - ray.shear_x * cz;
  const float cy = component(oc, ray.axis_y) - ray.shear_y * cz;
  const float reach = reach_of(a, b, c), size = std::fabs(az) + reach;
  const float error = size * (kErrorOfSquare * size + kErrorOfReach * reach);
  return {cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax, az, bz, cz, reach, size, error};
}

RAYSHEAF_HD inline bool surely_misses(const RaySetup& ray, Vec3 a, Vec3 b, Vec3 c) {
  return edges_of(ray, a, b, c).surely_miss();
}

/// det, and det times t, u and v, each with an error bound, which is half the value if none of the
/// 9 roundings cancels.
struct Determinants {
  double det, t, u, v;
  double det_error, t_error, u_error, v_error;

  /// Whether the quotients are accurate to 2^-27: t relative to itself, u and v relative to 1.
  [[nodiscard]] RAYSHEAF_HD bool give_values() const {
    const double size = std::fabs(det);
    return det_error <= 0x1p-28 * size && t_error <= 0x1p-28 * std::fabs(t) &&
           u_error <= 0x1p-28 * size && v_error <= 0x1p-28 * size;
  }
  [[nodiscard]] RAYSHEAF_HD bool are_finite() const {
    return det_error + t_error + u_error + v_error <= std::numeric_limits<double>::max();
  }
};

/// x - y of floats: the nearest float, and the rest with an error of 2^-77 of the difference
/// (T. Dekker, "A Floating-Point Technique for Extending the Available Precision", 1971).
struct DifferenceParts {
  double high, low;

  RAYSHEAF_HD DifferenceParts(float x_float, float y_float) {
    const double x = x_float, y = y_float, difference = x - y, y_part = difference - x;
    const double lost = (x - (difference - y_part)) - (y + y_part);
    high = static_cast<double>(static_cast<float>(difference));
    low = (difference - high) + lost;
  }
};

/// Stage 2. A difference has one rounding, so the terms of `det` have 7, of `t` 8, of `u` and `v` 7
/// roundings, each 2^-53 of their magnitudes.
///
/// The products of k x d grow with the distance to the origin, and cancel: from a hundred thousand
/// lengths away, these bounds of u and v exceed 2^-28 det. Then k is taken in two parts. Products
/// of `high` with a direction are exact. With S the sum of the magnitudes of two products, a
/// component m of k x d has an error of 2^-52 |m| + 2^-75 S: 2^-53 |m| of each sum, of which the
/// first is at most |m| + 2^-24 S, 2^-76 S in products with `low` and their difference, 2^-77 S in
/// k. A term of u has four roundings more, which makes 2^-53 (6 |m| + 2^-22 S) times the side; the
/// bound is 2^-50 (|m| + 2^-24 S).
RAYSHEAF_HD inline Determinants determinants(Vec3 origin, Vec3 direction, Vec3 a, Vec3 b, Vec3 c) {
  const auto minus = [](float x, float y) {
    return static_cast<double>(x) - static_cast<double>(y);
  };
  const double ex = minus(b.x, a.x), ey = minus(b.y, a.y), ez = minus(b.z, a.z);
  const double fx = minus(c.x, a.x), fy = minus(c.y, a.y), fz = minus(c.z, a.z);
  const double kx = minus(a.x, origin.x), ky = minus(a.y, origin.y), kz = minus(a.z, origin.z);
  const double dx = direction.x, dy = direction.y, dz = direction.z;
  struct Minor {
    double value, size;
  };
  const auto minor = [](double p, double q, double r, double s) {
    const double pq = p * q, rs = r * s;
    return Minor{pq - rs, std::fabs(pq) + std::fabs(rs)};
  };
  const Minor nx = minor(ey, fz, ez, fy), ny = minor(ez, fx, ex, fz), nz = minor(ex, fy, ey, fx);
  const auto value = [](Minor x, Minor y, Minor z, double p, double q, double r) {
    return x.value * p + y.value * q + z.value * r;
  };
  const auto size = [](Minor x, Minor y, Minor z, double p, double q, double r) {
    return x.size * std::fabs(p) + y.size * std::fabs(q) + z.size * std::fabs(r);
  };
  Determinants x{
      value(nx, ny, nz, dx, dy, dz),          value(nx, ny, nz, kx, ky, kz),          0, 0,
      0x1p-50 * size(nx, ny, nz, dx, dy, dz), 0x1p-49 * size(nx, ny, nz, kx, ky, kz), 0, 0};
  const auto take_weights = [&](Minor mx, Minor my, Minor mz) {
    x.u = value(mx, my, mz, fx, fy, fz), x.v = -value(mx, my, mz, ex, ey, ez);
    x.u_error = 0x1p-50 * size(mx, my, mz, fx, fy, fz);
    x.v_error = 0x1p-50 * size(mx, my, mz, ex, ey, ez);
  };
  take_weights(minor(ky, dz, kz, dy), minor(kz, dx, kx, dz), minor(kx, dy, ky, dx));
  const double small = 0x1p-28 * std::fabs(x.det);
  // A difference beyond all floats has no parts.
  if ((x.u_error > small || x.v_error > small) &&
      std::fabs(kx) + std::fabs(ky) + std::fabs(kz) <= std::numeric_limits<float>::max()) {
    const DifferenceParts px(a.x, origin.x), py(a.y, origin.y), pz(a.z, origin.z);
    const auto minor_of_parts = [](DifferenceParts p, double q, DifferenceParts r, double s) {
      const double pq = p.high * q, rs = r.high * s;
      const double sum = (pq - rs) + (p.low * q - r.low * s);
      return Minor{sum, std::fabs(sum) + 0x1p-24 * (std::fabs(pq) + std::fabs(rs))};
    };
    take_weights(minor_of_parts(py, dz, pz, dy), minor_of_parts(pz, dx, px, dz),
                 minor_of_parts(px, dy, py, dx));
  }
  return x;
}

/// The values of a hit, rounded once. u and v are in [0, 1]. If the line hits the triangle behind
/// the ray's origin, t stays negative, however small, and is never -0.
RAYSHEAF_HD inline TriangleHit rounded_hit(double t, double u, double v, bool front) {
  const auto weight = [](double x) {
    const auto rounded = static_cast<float>(x);
    return rounded > 0 ? (rounded < 1 ? rounded : 1.0f) : 0.0f;
  };
  const auto near_zero = t < 0 ? -std::numeric_limits<float>::denorm_min() : 0.0f;
  const auto rounded = static_cast<float>(t);
  return {rounded != 0 ? rounded : near_zero, weight(u), weight(v), front};
}

/// The values of a hit that stage 1, 2 or 3 has found.
RAYSHEAF_HD inline TriangleHit values_of_hit(Vec3 origin, Vec3 direction, Vec3 a, Vec3 b, Vec3 c) {
  const Determinants x = determinants(origin, direction, a, b, c);
  if (x.give_values()) return rounded_hit(x.t / x.det, x.u / x.det, x.v / x.det, x.det < 0);
  const WideAnswer answer = answer_in_integers(origin, direction, a, b, c);
  return rounded_hit(answer.t, answer.u, answer.v, answer.front);
}

/// The answer of a stage for a ray's line and a triangle.
enum class LineAnswer : std::uint8_t { kMisses, kMeets, kUnsure };

/// Stage 2: whether the ray's line hits the triangle, at any t. An unsure answer has no values and
/// needs stage 3.
RAYSHEAF_HD inline LineAnswer answer_in_doubles(Vec3 origin, Vec3 direction, Vec3 a, Vec3 b, Vec3 c,
                                                TriangleHit* hit) {
  const Determinants x = determinants(origin, direction, a, b, c);
  if (!x.are_finite()) return LineAnswer::kMisses;
  const double w = (x.det - x.u) - x.v;
  const double w_error = 2 * (x.det_error + x.u_error + x.v_error);
  const bool some_above = x.det > x.det_error || x.u > x.u_error || x.v > x.v_error || w > w_error;
  const bool some_below =
      x.det < -x.det_error || x.u < -x.u_error || x.v < -x.v_error || w < -w_error;
  if (some_above && some_below) return LineAnswer::kMisses;
  const bool settled = std::fabs(x.det) > x.det_error && std::fabs(x.u) > x.u_error &&
                       std::fabs(x.v) > x.v_error && std::fabs(w) > w_error;
  if (!settled || !x.give_values()) return LineAnswer::kUnsure;
  *hit = rounded_hit(x.t / x.det, x.u / x.det, x.v / x.det, x.det < 0);
  return LineAnswer::kMeets;
}

/// Stages 2 and 3.
RAYSHEAF_HD inline bool line_meets_triangle(Vec3 origin, Vec3 direction, Vec3 a, Vec3 b, Vec3 c,
                                            TriangleHit* hit) {
  const LineAnswer in_doubles = answer_in_doubles(origin, direction, a, b, c, hit);
  if (in_doubles != LineAnswer::kUnsure) return in_doubles == LineAnswer::kMeets;
  const WideAnswer answer = answer_in_integers(origin, direction, a, b, c);
  if (!answer.meets) return false;
  const Determinants x = determinants(origin, direction, a, b, c);
  *hit = x.give_values() ? rounded_hit(x.t / x.det, x.u / x.det, x.v / x.det, x.det < 0)
                         : rounded_hit(answer.t, answer.u, answer.v, answer.front);
  return true;
}

/// Whether a hit at `t` is in the interval; a t beyond the largest float is not.
RAYSHEAF_HD inline bool is_within(float t, float t_min, float t_max) {
  return t >= t_min && t <= t_max && t < std::numeric_limits<float>::infinity();
}

/// Whether the ray hits the triangle with `t` in [t_min, t_max]. Triangles without area or with
/// non-finite corners are never hit.
RAYSHEAF_HD inline bool intersect_triangle(const RaySetup& ray, Vec3 a, Vec3 b, Vec3 c,
                                           TriangleHit* hit) {
  return !surely_misses(ray, a, b, c) &&
         line_meets_triangle(ray.origin, ray.direction, a, b, c, hit) &&
         is_within(hit->t, ray.t_min, ray.t_max);
}

/// The weights of the second and third corner where the ray intersects the triangle's plane,
/// clamped to the triangle: at silhouettes, OpenGL's pixel may be slightly outside.
RAYSHEAF_HD inline Vec2 clamped_barycentrics(const Ray& ray, Vec3 a, Vec3 b, Vec3 c) {
  TriangleHit hit;
  if (intersect_triangle(make_ray_setup(ray), a, b, c, &hit)) return {hit.u, hit.v};
  const Vec3 ab = b - a, ac = c - a, from = ray.origin - a;
  const Vec3 p = cross(ray.direction, ac), q = cross(from, ab);
  const float det = dot(ab, p);
  if (!(det != 0)) return {1.0f / 3, 1.0f / 3};
  const float u = clamp(dot(from, p) / det, 0, 1), v = clamp(dot(ray.direction, q) / det, 0, 1);
  const float sum = u + v;
  return sum > 1 ? Vec2{u / sum, v / sum} : Vec2{u, v};
}

}  // namespace raysheaf
