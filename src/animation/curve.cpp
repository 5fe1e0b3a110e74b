#include "animation/curve.h"

#include <algorithm>
#include <cmath>

#include "base/trigonometry.h"

namespace raysheaf {
namespace {

using Quaternion = std::array<double, 4>;

/// The position of a time among the keys: the fraction `part` of the way from `key` to the next
/// one.
struct Moment {
  std::size_t key = 0;
  double part = 0, seconds = 0;  ///< `seconds`: between the two keys
};

Moment moment_of(const Curve& curve, double time) {
  const auto& times = curve.times;
  if (!(time > times.front())) return {};
  if (time >= times.back()) return {times.size() - 1, 0, 0};
  // The time of a key finds this key, the one before its successor.
  const auto after = std::upper_bound(times.begin(), times.end(), time,
                                      [](double t, float key) { return t < key; });
  Moment m;
  m.key = static_cast<std::size_t>(after - times.begin()) - 1;
  m.seconds = static_cast<double>(times[m.key + 1]) - times[m.key];
  m.part = (time - times[m.key]) / m.seconds;
  return m;
}

/// Hermite's cubic between two keys: in curve.values each key has its incoming tangent, its value
/// and its outgoing tangent.
double hermite(const float* key, std::size_t width, std::size_t i, const Moment& m) {
  const float* next = key + 3 * width;
  const double t = m.part, t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * key[width + i] +
         m.seconds * (t3 - 2 * t2 + t) * key[2 * width + i] + (3 * t2 - 2 * t3) * next[width + i] +
         m.seconds * (t3 - t2) * next[i];
}

Quaternion unit_quaternion(Quaternion q) {
  const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(n > 0)) return {0, 0, 0, 1};
  for (double& x : q) x /= n;
  return q;
}

Quaternion key_rotation(const Curve& curve, std::size_t key) {
  const float* q = curve.values.data() + 4 * key;
  return unit_quaternion({q[0], q[1], q[2], q[3]});
}

/// Interpolates unit quaternions along the shorter arc (Shoemake 1985, "Animating Rotation with
/// Quaternion Curves").
Quaternion slerp(const Quaternion& a, Quaternion b, double part) {
  double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  if (cosine < 0) {
    cosine = -cosine;
    for (double& x : b) x = -x;
  }
  const auto sine_of = [](double x) { return portable::sine_cosine(x).sine; };
  const double angle = portable::arc_cosine(std::min(cosine, 1.0)), sine = sine_of(angle);
  // For such small angles the chord equals the arc.
  const bool near = sine < 1e-9;
  const double of_a = near ? 1 - part : sine_of((1 - part) * angle) / sine;
  const double of_b = near ? part : sine_of(part * angle) / sine;
  Quaternion q;
  for (std::size_t i = 0; i < 4; ++i) q[i] = of_a * a[i] + of_b * b[i];
  return unit_quaternion(q);
}

}  // namespace

void sample_curve(const Curve& curve, double time, std::span<double> value) {
  const std::size_t width = value.size();
  const Moment m = moment_of(curve, time);
  const bool cubic = curve.interpolation == Interpolation::kCubicSpline;
  const float* key = curve.values.data() + (cubic ? 3 * width : width) * m.key;
  const bool at_key = m.part == 0 || curve.interpolation == Interpolation::kStep;
  for (std::size_t i = 0; i < width; ++i) {
    if (at_key) {
      value[i] = key[cubic ? width + i : i];
    } else if (cubic) {
      value[i] = hermite(key, width, i, m);
    } else {
      value[i] = (1 - m.part) * key[i] + m.part * key[width + i];
    }
  }
}

std::array<double, 4> sample_rotation(const Curve& curve, double time) {
  if (curve.interpolation == Interpolation::kLinear) {
    const Moment m = moment_of(curve, time);
    const Quaternion a = key_rotation(curve, m.key);
    return m.part == 0 ? a : slerp(a, key_rotation(curve, m.key + 1), m.part);
  }
  Quaternion q;
  sample_curve(curve, time, q);
  return unit_quaternion(q);
}

}  // namespace raysheaf
