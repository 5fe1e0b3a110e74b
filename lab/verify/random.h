// Random numbers with the same values on every machine. Seeding is cheap: each round and each ray
// has its own seed, so that rays can be made by all threads.
//
// A call, or one side of +, draws at most once: compilers evaluate arguments and operands in
// different orders.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "base/vec.h"

namespace raysheaf::checks {

/// SplitMix64 (G. Steele, D. Lea, C. Flood, "Fast Splittable Pseudorandom Number Generators",
/// 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(mixed(seed)) {}
  /// Number `index` of a family of independent generators.
  Random(std::uint64_t seed, std::uint64_t index) : Random(seed ^ mixed(~index)) {}

  std::uint64_t bits() { return mixed(state_ += 0x9e3779b97f4a7c15u); }
  /// In [0, n); n must not be 0.
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>(((bits() >> 32) * n) >> 32);
  }
  bool one_in(std::uint32_t n) { return below(n) == 0; }
  /// [0, 1)
  float unit() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }
  float between(float lo, float hi) { return lo + (hi - lo) * unit(); }
  /// 10^x for x uniformly between the two.
  float magnitude(float lo, float hi) { return std::pow(10.0f, between(lo, hi)); }
  Vec3 in_box(float half) {
    const float x = between(-half, half), y = between(-half, half);
    return {x, y, between(-half, half)};
  }
  Vec3 in_triangle(const std::array<Vec3, 3>& t) {
    const float v = unit(), u = unit();
    return lerp(lerp(t[0], t[1], u), t[2], v);
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 d = in_box(1);
      const float n = dot(d, d);
      if (n > 1e-4f && n <= 1) return normalized(d);
    }
  }

 private:
  static std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

}  // namespace raysheaf::checks
