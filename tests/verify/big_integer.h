// Integers that hold every determinant of three rows of float differences, in units of 2^-447: the
// simplest exact arithmetic, as a reference for the faster one.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace raysheaf::test {

/// Two's complement with 896 bits: a difference of floats is below 2^278 units of 2^-149, so a
/// determinant is below 2^837 units. Overflow is not checked.
class BigInteger {
 public:
  BigInteger() = default;
  /// Exact, in units of 2^-149.
  explicit BigInteger(float x) {
    int exponent;
    const auto digits = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 24));
    // x = digits 2^(exponent - 24); denormals have fewer digits.
    int shift = exponent - 24 + 149;
    std::int64_t whole = digits < 0 ? -digits : digits;
    for (; shift < 0; ++shift) whole /= 2;  // for denormals, removes zeros
    const auto limb = static_cast<std::size_t>(shift / 64),
               bit = static_cast<std::size_t>(shift % 64);
    limbs_[limb] = static_cast<std::uint64_t>(whole) << bit;
    if (bit != 0) limbs_[limb + 1] = static_cast<std::uint64_t>(whole) >> (64 - bit);
    if (digits < 0) *this = -*this;
  }

  friend BigInteger operator+(const BigInteger& a, const BigInteger& b) {
    BigInteger sum;
    std::uint64_t carry = 0;
    for (std::size_t i = 0; i < kLimbs; ++i) {
      const Two x = Two{a.limbs_[i]} + b.limbs_[i] + carry;
      sum.limbs_[i] = static_cast<std::uint64_t>(x);
      carry = static_cast<std::uint64_t>(x >> 64);
    }
    return sum;
  }
  BigInteger operator-() const {
    BigInteger flipped, one;
    for (std::size_t i = 0; i < kLimbs; ++i) flipped.limbs_[i] = ~limbs_[i];
    one.limbs_[0] = 1;
    return flipped + one;
  }
  friend BigInteger operator-(const BigInteger& a, const BigInteger& b) { return a + -b; }
  /// Modulo 2^896, which is also right for negative numbers.
  friend BigInteger operator*(const BigInteger& a, const BigInteger& b) {
    BigInteger product;
    for (std::size_t i = 0; i < kLimbs; ++i) {
      if (a.limbs_[i] == 0) continue;
      std::uint64_t carry = 0;
      for (std::size_t j = 0; i + j < kLimbs; ++j) {
        const Two x = Two{a.limbs_[i]} * b.limbs_[j] + product.limbs_[i + j] + carry;
        product.limbs_[i + j] = static_cast<std::uint64_t>(x);
        carry = static_cast<std::uint64_t>(x >> 64);
      }
    }
    return product;
  }

  [[nodiscard]] int sign() const {
    if ((limbs_.back() >> 63) != 0) return -1;
    for (const std::uint64_t limb : limbs_)
      if (limb != 0) return 1;
    return 0;
  }
  /// The integer times 2^power, with a relative error of 2^-50.
  [[nodiscard]] double value(int power) const {
    if (sign() < 0) return -(-*this).value(power);
    std::size_t top = kLimbs - 1;
    while (top > 0 && limbs_[top] == 0) --top;
    double result = 0;
    for (std::size_t i = top + 1; i-- > 0 && i + 3 > top;)
      result += std::ldexp(static_cast<double>(limbs_[i]), static_cast<int>(64 * i) + power);
    return result;
  }

 private:
  __extension__ using Two = unsigned __int128;
  static constexpr std::size_t kLimbs = 14;
  std::array<std::uint64_t, kLimbs> limbs_{};
};

}  // namespace raysheaf::test
