// The determinants of a ray and a triangle without rounding: integers of a fixed number of words,
// for the few pairs that binary64 does not decide (intersect/triangle_body.h).
//
// All coordinates are multiples of a power of two, the unit of positions, and components of the
// direction are multiples of another. Therefore every determinant is an integer of 3 * kWords
// words:
//
//   corners and origin   | span |            kWords      differences: one bit more
//   direction            | span |            kWords
//   edge x edge          | 2 (span + 1) + 1  | 2 kWords
//   determinant          | 3 span + 6                   | 3 kWords
//
// Floats span at most 277 bits, from 2^-149 to 2^128, which fit into five words. Coordinates of
// similar magnitude, and integers, span less than 62 bits and fit into one word, which takes a
// tenth of the time.
#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#include "base/bits.h"
#include "base/vec.h"

namespace raysheaf {

__extension__ using DoubleWord = unsigned __int128;

/// Two's complement, lowest word first. Operations wrap around; callers provide enough words.
template <int kWords>
struct WideInt {
  std::uint64_t word[kWords] = {};

  [[nodiscard]] RAYSHEAF_HD bool is_negative() const { return word[kWords - 1] >> 63 != 0; }
  /// -1, 0 or 1.
  [[nodiscard]] RAYSHEAF_HD int sign() const {
    if (is_negative()) return -1;
    RAYSHEAF_ROLLED
    for (const std::uint64_t w : word)
      if (w != 0) return 1;
    return 0;
  }
};

template <int kWords>
RAYSHEAF_HD inline WideInt<kWords> operator-(const WideInt<kWords>& a, const WideInt<kWords>& b) {
  WideInt<kWords> result;
  std::uint64_t borrow = 0;
  RAYSHEAF_ROLLED
  for (int i = 0; i < kWords; ++i) {
    const std::uint64_t less = a.word[i] - b.word[i];
    result.word[i] = less - borrow;
    borrow = (a.word[i] < b.word[i] ? 1u : 0u) | (less < borrow ? 1u : 0u);
  }
  return result;
}

template <int kWords>
RAYSHEAF_HD inline WideInt<kWords> operator+(const WideInt<kWords>& a, const WideInt<kWords>& b) {
  return a - (WideInt<kWords>{} - b);
}

/// The product, which always fits.
template <int kA, int kB>
RAYSHEAF_HD inline WideInt<kA + kB> operator*(const WideInt<kA>& a, const WideInt<kB>& b) {
  WideInt<kA + kB> result;
  RAYSHEAF_ROLLED
  for (int i = 0; i < kA; ++i) {
    std::uint64_t carry = 0;
    RAYSHEAF_ROLLED
    for (int j = 0; j < kB; ++j) {
      const DoubleWord sum = DoubleWord{a.word[i]} * b.word[j] + result.word[i + j] + carry;
      result.word[i + j] = static_cast<std::uint64_t>(sum);
      carry = static_cast<std::uint64_t>(sum >> 64);
    }
    result.word[i + kB] = carry;
  }
  // So far both factors were treated as unsigned: a negative one was 2^64k too large.
  const auto take_from_above = [&](int first, const std::uint64_t* words, int count) {
    std::uint64_t borrow = 0;
    RAYSHEAF_ROLLED
    for (int i = 0; i < count; ++i) {
      std::uint64_t& to = result.word[first + i];
      const std::uint64_t less = to - words[i];
      const std::uint64_t next = (to < words[i] ? 1u : 0u) | (less < borrow ? 1u : 0u);
      to = less - borrow;
      borrow = next;
    }
  };
  if (a.is_negative()) take_from_above(kA, b.word, kB);
  if (b.is_negative()) take_from_above(kB, a.word, kA);
  return result;
}

/// The nearest double, with a relative error of 2^-52.
template <int kWords>
RAYSHEAF_HD inline double to_double(WideInt<kWords> a) {
  const bool negative = a.is_negative();
  if (negative) a = WideInt<kWords>{} - a;
  int top = kWords - 1;
  while (top > 0 && a.word[top] == 0) --top;
  double value = static_cast<double>(a.word[top]);
  if (top > 0) value += static_cast<double>(a.word[top - 1]) * 0x1p-64;
  value = std::ldexp(value, 64 * top);
  return negative ? -value : value;
}

/// Coordinates that span at most this many bits need one word.
inline constexpr int kOneWord = 61;

/// The powers of two between which floats lie: multiples of 2^low, below 2^high.
struct BitSpan {
  int low = 1024, high = -1024;

  RAYSHEAF_HD void include(float x) {
    const std::uint32_t bits = float_bits(x) & 0x7fffffffu;
    if (bits == 0) return;
    const auto exponent = static_cast<int>(bits >> 23);
    const std::uint32_t fraction = (bits & 0x7fffffu) | (exponent != 0 ? 0x800000u : 0);
    const int unit = (exponent != 0 ? exponent : 1) - 150;
    const int lowest = unit + trailing_zeros(fraction);
    const int highest = unit + 64 - leading_zeros(fraction);
    low = lowest < low ? lowest : low;
    high = highest > high ? highest : high;
  }
  RAYSHEAF_HD void include(Vec3 a) {
    include(a.x);
    include(a.y);
    include(a.z);
  }
  [[nodiscard]] RAYSHEAF_HD int bits() const { return high > low ? high - low : 0; }
};

/// x / 2^low, which must be an integer that fits.
template <int kWords>
RAYSHEAF_HD inline WideInt<kWords> to_wide(float x, int low) {
  WideInt<kWords> result;
  const std::uint32_t bits = float_bits(x) & 0x7fffffffu;
  if (bits == 0) return result;
  const auto exponent = static_cast<int>(bits >> 23);
  const std::uint64_t fraction = (bits & 0x7fffffu) | (exponent != 0 ? 0x800000u : 0);
  const int shift = (exponent != 0 ? exponent : 1) - 150 - low;
  if (shift < 0) {
    result.word[0] = fraction >> -shift;
  } else {
    const int first = shift / 64, within = shift % 64;
    result.word[first] = fraction << within;
    if (within > 40 && first + 1 < kWords) result.word[first + 1] = fraction >> (64 - within);
  }
  return std::signbit(x) ? WideInt<kWords>{} - result : result;
}

template <int kWords>
struct WideVector {
  WideInt<kWords> x, y, z;
};

template <int kWords>
RAYSHEAF_HD inline WideVector<kWords> to_wide(Vec3 a, int low) {
  return {to_wide<kWords>(a.x, low), to_wide<kWords>(a.y, low), to_wide<kWords>(a.z, low)};
}
template <int kWords>
RAYSHEAF_HD inline WideVector<kWords> operator-(const WideVector<kWords>& a,
                                                const WideVector<kWords>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <int kWords>
RAYSHEAF_HD inline WideVector<2 * kWords> cross(const WideVector<kWords>& a,
                                                const WideVector<kWords>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <int kA, int kB>
RAYSHEAF_HD inline WideInt<kA + kB> dot(const WideVector<kA>& a, const WideVector<kB>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Whether the ray's line intersects the closed triangle in one point, and where, with a relative
/// error of 2^-49.
struct WideAnswer {
  bool meets;
  double t, u, v;
  bool front;
};

template <int kWords>
RAYSHEAF_HD_CALLED inline WideAnswer answer_in_words(Vec3 origin, Vec3 direction, Vec3 a, Vec3 b,
                                                     Vec3 c, int position_unit,
                                                     int direction_unit) {
  const WideVector<kWords> corner = to_wide<kWords>(a, position_unit);
  const WideVector<kWords> along = to_wide<kWords>(direction, direction_unit);
  const WideVector<kWords> to_b = to_wide<kWords>(b, position_unit) - corner;
  const WideVector<kWords> to_c = to_wide<kWords>(c, position_unit) - corner;
  const WideVector<kWords> to_corner = corner - to_wide<kWords>(origin, position_unit);
  const WideVector<2 *kWords> normal = cross(to_b, to_c), across = cross(to_corner, along);
  const WideInt<3 * kWords> det = dot(normal, along);
  const WideInt<3 *kWords> u = dot(across, to_c), v = WideInt<3 * kWords>{} - dot(across, to_b);
  const WideInt<3 * kWords> w = det - u - v;
  const int side = det.sign();
  if (side == 0 || side * u.sign() < 0 || side * v.sign() < 0 || side * w.sign() < 0)
    return {false, 0, 0, 0, false};
  const double size = to_double(det), distance = to_double(dot(normal, to_corner));
  return {true, std::ldexp(distance / size, position_unit - direction_unit), to_double(u) / size,
          to_double(v) / size, side < 0};
}

/// For finite floats. Takes a tenth of a microsecond, or a few if magnitudes differ greatly.
RAYSHEAF_HD inline WideAnswer answer_in_integers(Vec3 origin, Vec3 direction, Vec3 a, Vec3 b,
                                                 Vec3 c) {
  BitSpan positions, directions;
  for (const Vec3 p : {origin, a, b, c}) positions.include(p);
  directions.include(direction);
  if (positions.bits() <= kOneWord && directions.bits() <= kOneWord)
    return answer_in_words<1>(origin, direction, a, b, c, positions.low, directions.low);
  return answer_in_words<5>(origin, direction, a, b, c, positions.low, directions.low);
}

/// Whether three points lie on a line.
RAYSHEAF_HD inline bool are_in_line(Vec3 a, Vec3 b, Vec3 c) {
  BitSpan span;
  for (const Vec3 p : {a, b, c}) span.include(p);
  const auto by_words = [&](auto words) {
    constexpr int kWords = decltype(words)::value;
    const WideVector<kWords> corner = to_wide<kWords>(a, span.low);
    const auto normal =
        cross(to_wide<kWords>(b, span.low) - corner, to_wide<kWords>(c, span.low) - corner);
    return normal.x.sign() == 0 && normal.y.sign() == 0 && normal.z.sign() == 0;
  };
  return span.bits() <= kOneWord ? by_words(std::integral_constant<int, 1>{})
                                 : by_words(std::integral_constant<int, 5>{});
}

}  // namespace raysheaf
