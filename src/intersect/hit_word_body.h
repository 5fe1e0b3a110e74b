// Hits encoded as words, so that a device keeps the best of many by an atomic minimum.
//
//   63                 32 31                 0
//   | t, as ordered bits | triangle's number |      all bits set: no hit
#pragma once

#include <cstdint>

#include "base/bits.h"

namespace raysheaf {

inline constexpr std::uint64_t kNoHitWord = ~std::uint64_t{0};

/// Ascending by (t, triangle), for t >= 0; -0 is encoded as 0.
RAYSHEAF_HD inline std::uint64_t hit_word(float t, std::uint32_t triangle) {
  return std::uint64_t{float_bits(t + 0.0f)} << 32 | triangle;
}
RAYSHEAF_HD inline std::uint32_t triangle_of_word(std::uint64_t word) {
  return static_cast<std::uint32_t>(word);
}

}  // namespace raysheaf
