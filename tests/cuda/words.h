// Random input and output words that host and device both compute, so that they can be compared.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/bits.h"
#include "base/vec.h"

namespace raysheaf::test {

/// Gives the same numbers for the same index on every machine: PCG's output function on a counter
/// (M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020). An argument list
/// or an operator's operands may hold at most one drawing call, because the compiler chooses their
/// order.
class Draws {
 public:
  RAYSHEAF_HD explicit Draws(std::uint32_t index) : state_(index * 0x9e3779b9u + 1) {}

  RAYSHEAF_HD std::uint32_t bits() {
    state_ = state_ * 747796405u + 2891336453u;
    const std::uint32_t word = ((state_ >> ((state_ >> 28) + 4)) ^ state_) * 277803737u;
    return (word >> 22) ^ word;
  }
  RAYSHEAF_HD std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>((std::uint64_t{bits()} * n) >> 32);
  }
  /// [0, 1)
  RAYSHEAF_HD float unit() { return static_cast<float>(bits() >> 8) * 0x1p-24f; }
  RAYSHEAF_HD float between(float lo, float hi) { return lo + (hi - lo) * unit(); }
  RAYSHEAF_HD Vec3 in_box(float half) {
    const float x = between(-half, half), y = between(-half, half), z = between(-half, half);
    return {x, y, z};
  }
  RAYSHEAF_HD Vec3 direction() { return normalized(in_box(1)); }
  RAYSHEAF_HD Affine map() {
    Affine a;
    for (auto& row : a.m)
      for (float& x : row) x = between(-2, 2);
    return a;
  }
  /// One of several magnitudes, to reach the ends of the range of floats.
  RAYSHEAF_HD float scale() {
    const float scales[4] = {1, 1e-20f, 1e-3f, 1e9f};
    return scales[below(4)];
  }

 private:
  std::uint32_t state_;
};

/// The results of a case, as bits. All NaNs count as equal, because devices may return different
/// ones.
struct Words {
  static constexpr std::uint32_t kRoom = 56;
  std::uint32_t bits[kRoom]{};
  std::uint32_t count = 0;

  RAYSHEAF_HD void put(std::uint32_t x) {
    if (count < kRoom) bits[count] = x;
    ++count;
  }
  RAYSHEAF_HD void put(std::uint64_t x) {
    put(static_cast<std::uint32_t>(x >> 32) * 31u + static_cast<std::uint32_t>(x));
  }
  RAYSHEAF_HD void put(bool x) { put(x ? 1u : 0u); }
  RAYSHEAF_HD void put(int x) { put(static_cast<std::uint32_t>(x)); }
  RAYSHEAF_HD void put(float x) { put(x == x ? float_bits(x) : 0x7fc00000u); }
  RAYSHEAF_HD void put(double x) {
    std::uint64_t all = 0x7ff8000000000000u;
    if (x == x) std::memcpy(&all, &x, sizeof all);
    put(all);
  }
  RAYSHEAF_HD void put(Vec2 a) {
    put(a.x);
    put(a.y);
  }
  RAYSHEAF_HD void put(Vec3 a) {
    put(a.x);
    put(a.y);
    put(a.z);
  }
  RAYSHEAF_HD void put(const Vec4& a) {
    put(Vec3{a.x, a.y, a.z});
    put(a.w);
  }
  RAYSHEAF_HD void put(const Affine& a) {
    for (const auto& row : a.m)
      for (const float x : row) put(x);
  }
  RAYSHEAF_HD void put(const Ray& ray) {
    put(ray.origin);
    put(ray.t_min);
    put(ray.direction);
    put(ray.t_max);
  }
  template <class First, class Second, class... Rest>
  RAYSHEAF_HD void put(const First& first, const Second& second, const Rest&... rest) {
    put(first);
    put(second);
    (put(rest), ...);
  }
};

/// The index of the first word that differs; `kRoom` if all are equal.
inline std::uint32_t first_difference(const Words& a, const Words& b) {
  std::uint32_t k = 0;
  while (k < Words::kRoom && a.bits[k] == b.bits[k]) ++k;
  return k;
}
inline bool operator==(const Words& a, const Words& b) {
  return a.count == b.count && first_difference(a, b) == Words::kRoom;
}

}  // namespace raysheaf::test
