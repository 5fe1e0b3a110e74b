// Integers as rows of bits.
#pragma once

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

RAYSHEAF_HD inline std::uint32_t div_ceil(std::uint64_t a, std::uint64_t b) {
  return static_cast<std::uint32_t>((a + b - 1) / b);
}

/// How many bits number `count` things: the least b with `2^b >= count`.
RAYSHEAF_HD inline std::uint32_t bits_for(std::uint32_t count) {
  std::uint32_t bits = 0;
  while (bits < 32 && (std::uint64_t{1} << bits) < count) ++bits;
  return bits;
}

/// Sixteen bits moved apart, a zero above each: `...0d 0c 0b 0a`.
RAYSHEAF_HD inline std::uint32_t spread_by_2(std::uint32_t x) {
  x &= 0x0000ffffu;
  x = (x | (x << 8)) & 0x00ff00ffu;
  x = (x | (x << 4)) & 0x0f0f0f0fu;
  x = (x | (x << 2)) & 0x33333333u;
  return (x | (x << 1)) & 0x55555555u;
}
/// Ten bits moved apart, two zeros above each.
RAYSHEAF_HD inline std::uint32_t spread_by_3(std::uint32_t x) {
  x &= 0x000003ffu;
  x = (x | (x << 16)) & 0x030000ffu;
  x = (x | (x << 8)) & 0x0300f00fu;
  x = (x | (x << 4)) & 0x030c30c3u;
  return (x | (x << 2)) & 0x09249249u;
}
RAYSHEAF_HD inline std::uint32_t morton_2(std::uint32_t x, std::uint32_t y) {
  return spread_by_2(x) | (spread_by_2(y) << 1);
}
RAYSHEAF_HD inline std::uint32_t morton_3(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread_by_3(x) | (spread_by_3(y) << 1) | (spread_by_3(z) << 2);
}

}  // namespace raysheaf
