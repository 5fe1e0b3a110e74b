// Sines, cosines and their inverses, computed only by sums, products, quotients and square roots.
// Every machine gets the same bits, which different standard libraries do not guarantee. Errors are
// a few units in the last place of binary64.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/host_device.h"

namespace raysheaf::portable {

inline constexpr double kPi = 3.14159265358979323846;

/// Horner's rule: the constant term first, then the coefficients of z, z^2 and so on.
RAYSHEAF_HD constexpr double polynomial(double /*z*/, double last) {
  return last;
}
template <class... More>
RAYSHEAF_HD constexpr double polynomial(double z, double first, More... more) {
  return first + z * polynomial(z, more...);
}

/// For angles up to pi / 4, by a Taylor series to the precision of binary64.
RAYSHEAF_HD inline double small_sine(double x) {
  const double z = x * x;  // 3!, 5! and so on
  return x + x * z *
                 polynomial(z, -1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800,
                            1.0 / 6227020800, -1.0 / 1307674368000, 1.0 / 355687428096000);
}
RAYSHEAF_HD inline double small_cosine(double x) {
  const double z = x * x;  // 4!, 6! and so on
  return 1 - 0.5 * z +
         z * z *
             polynomial(z, 1.0 / 24, -1.0 / 720, 1.0 / 40320, -1.0 / 3628800, 1.0 / 479001600,
                        -1.0 / 87178291200, 1.0 / 20922789888000);
}

struct SineCosine {
  double sine, cosine;
};
/// For angles up to a million radians.
RAYSHEAF_HD inline SineCosine sine_cosine(double angle) {
  // Half pi in two parts; the first has 33 bits, so that its multiples are exact (W. Cody, W.
  // Waite, "Software Manual for the Elementary Functions", 1980).
  constexpr double kLarge = 0x1.921fb544p+0, kSmall = 0x1.0b4611a626331p-34;
  const double quarters = std::floor(angle * (2 / kPi) + 0.5);
  const double rest = (angle - quarters * kLarge) - quarters * kSmall;
  const double s = small_sine(rest), c = small_cosine(rest);
  switch (static_cast<std::int32_t>(quarters) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

/// For angles as in `sine_cosine`; on the host.
inline double tangent(double angle) {
  const SineCosine of = sine_cosine(angle);
  return of.sine / of.cosine;
}

/// The angle between (x, y) and the x axis, in [-pi, pi]; 0 at the origin.
RAYSHEAF_HD inline double angle_of(double y, double x) {
  constexpr double kEighth = 0.41421356237309503;  // tan(pi / 8)
  const double height = std::fabs(y), width = std::fabs(x);
  const bool steep = height > width;
  const double high = steep ? height : width, low = steep ? width : height;
  const double tangent = high == 0 ? 0 : low / high;
  // Reduces [0, 1] to a small tangent, and then halves its angle.
  const bool large = tangent > kEighth;
  const double t = large ? (tangent - 1) / (tangent + 1) : tangent;
  const double half = t / (1 + std::sqrt(1 + t * t));
  const double z = half * half;
  const double sum = polynomial(z, -1.0 / 3, 1.0 / 5, -1.0 / 7, 1.0 / 9, -1.0 / 11, 1.0 / 13,
                                -1.0 / 15, 1.0 / 17, -1.0 / 19, 1.0 / 21, -1.0 / 23);
  double angle = 2 * (half + half * z * sum);
  if (large) angle += kPi / 4;
  if (steep) angle = kPi / 2 - angle;
  if (x < 0) angle = kPi - angle;
  return y < 0 ? -angle : angle;
}

/// In [0, pi], for cosines in [-1, 1].
RAYSHEAF_HD inline double arc_cosine(double cosine) {
  return angle_of(std::sqrt((1 - cosine) * (1 + cosine)), cosine);
}

}  // namespace raysheaf::portable
