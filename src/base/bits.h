// Operations on the bits of integers.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "base/host_device.h"

namespace raysheaf {

RAYSHEAF_HD inline std::uint32_t float_bits(float x) {
  std::uint32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
RAYSHEAF_HD inline float bits_float(std::uint32_t bits) {
  float x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}

/// `x` must not be 0. Device code must not use <bit>: nvcc 13.0 compiles std::countl_zero and
/// std::countr_zero of libstdc++ 12 to the constants 64 and 32.
RAYSHEAF_HD inline int leading_zeros(std::uint64_t x) {
#ifdef __CUDA_ARCH__
  return __clzll(static_cast<long long>(x));
#else
  return std::countl_zero(x);
#endif
}
RAYSHEAF_HD inline int trailing_zeros(std::uint32_t x) {
#ifdef __CUDA_ARCH__
  return __ffs(static_cast<int>(x)) - 1;
#else
  return std::countr_zero(x);
#endif
}

RAYSHEAF_HD inline std::uint32_t div_ceil(std::uint64_t a, std::uint64_t b) {
  return static_cast<std::uint32_t>((a + b - 1) / b);
}

/// The number of bits that number `count` things: the least b with `2^b >= count`.
RAYSHEAF_HD inline std::uint32_t bits_for(std::uint32_t count) {
  std::uint32_t bits = 0;
  while (bits < 32 && (std::uint64_t{1} << bits) < count) ++bits;
  return bits;
}

}  // namespace raysheaf
