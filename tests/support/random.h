// Random numbers with the same values everywhere: PCG (M. O'Neill, 2014), XSH-RR variant.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/vec.h"

namespace raysheaf::test {

class Random {
 public:
  explicit Random(std::uint64_t seed = 1)
      : state_(seed * 0x9e3779b97f4a7c15u + 0xda3e39cb94b95bdbu) {}

  std::uint32_t bits() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005u + 1442695040888963407u;
    const auto xored = static_cast<std::uint32_t>(((old >> 18u) ^ old) >> 27u);
    const auto turn = static_cast<std::uint32_t>(old >> 59u);
    return (xored >> turn) | (xored << ((32 - turn) & 31));
  }
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>((std::uint64_t{bits()} * n) >> 32);
  }
  /// [0, 1)
  float unit() { return static_cast<float>(bits() >> 8) * 0x1p-24f; }
  float between(float lo, float hi) { return lo + (hi - lo) * unit(); }
  Vec3 in_box(float half) {
    return {between(-half, half), between(-half, half), between(-half, half)};
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 d = in_box(1);
      const float n = dot(d, d);
      if (n > 1e-4f && n <= 1) return normalized(d);
    }
  }
  /// A direction within about `spread` of an axis.
  Vec3 direction_near(Vec3 axis, float spread) {
    return normalized(axis + direction() * (spread * unit()));
  }

 private:
  std::uint64_t state_;
};

}  // namespace raysheaf::test
