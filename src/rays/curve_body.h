// Positions of cells along space-filling curves, in two to six dimensions.
//
//   Morton              Hilbert           the same cells, 4 x 4; on a curve that never jumps,
//   o-o o-o             o o-o o           neighbours along the curve are neighbours in space
//    /  | /             |_|_|_|
//   o-o o-o ...
#pragma once

#include <cstdint>

#include "base/host_device.h"

namespace raysheaf {

/// A cell of a grid with 2^bits cells per side.
template <int kDimensions>
struct Cell {
  std::uint32_t axis[kDimensions];
};

/// The most bits per axis for which a position fits into 64 bits.
template <int kDimensions>
inline constexpr std::uint32_t kMostCellBits = 64 / kDimensions < 32 ? 64 / kDimensions : 32;

/// Groups of `group` ones, one every `group * dimensions` bits.
RAYSHEAF_HD constexpr std::uint64_t spread_mask(std::uint32_t group, std::uint32_t dimensions) {
  std::uint64_t mask = 0;
  for (std::uint32_t bit = 0; bit < 64; ++bit)
    if (bit % (group * dimensions) < group) mask |= std::uint64_t{1} << bit;
  return mask;
}

template <int kDimensions, std::uint32_t kGroup>
RAYSHEAF_HD inline std::uint64_t spread_groups(std::uint64_t x) {
  if constexpr (kGroup == 0) {
    return x;
  } else {
    constexpr std::uint64_t kMask = spread_mask(kGroup, kDimensions);
    return spread_groups<kDimensions, kGroup / 2>((x | (x << (kGroup * (kDimensions - 1)))) &
                                                  kMask);
  }
}

/// The bits of `x` spread apart, with `kDimensions - 1` zeros above each.
template <int kDimensions>
RAYSHEAF_HD inline std::uint64_t spread(std::uint32_t x) {
  return spread_groups<kDimensions, (kMostCellBits<kDimensions> > 16 ? 16 : 8)>(x);
}

/// G. M. Morton 1966: the bits of the axes interleaved, the first axis on top.
template <int kDimensions>
RAYSHEAF_HD inline std::uint64_t morton_place(const Cell<kDimensions>& cell) {
  std::uint64_t place = 0;
  for (int i = 0; i < kDimensions; ++i) place = (place << 1) | spread<kDimensions>(cell.axis[i]);
  return place;
}

/// One bit of one axis: if it is set, the lower bits of the first axis are inverted; otherwise,
/// they are exchanged with those of this axis.
RAYSHEAF_HD inline void turn_back(std::uint32_t bit, std::uint32_t& first, std::uint32_t& other) {
  const std::uint32_t below = (1u << bit) - 1;
  const std::uint32_t set = 0u - ((other >> bit) & 1u);
  const std::uint32_t swapped = (first ^ other) & below & ~set;
  first ^= swapped | (below & set);
  other ^= swapped;
}

/// J. Skilling, "Programming the Hilbert curve", AIP Conference Proceedings 707 (2004), 381-387.
///
/// From the coarsest bit down, the rotations of the sub-cubes are removed from the lower bits. The
/// result is a Gray code over all bits, which is decoded across the axes and then down the bits.
template <int kDimensions>
RAYSHEAF_HD inline std::uint64_t hilbert_place(Cell<kDimensions> cell, std::uint32_t bits) {
  static_assert(kDimensions >= 2 && kDimensions <= 6);
  std::uint32_t* x = cell.axis;
  for (std::uint32_t bit = bits; bit-- > 1;) {
    x[0] ^= ((1u << bit) - 1) & (0u - ((x[0] >> bit) & 1u));
    turn_back(bit, x[0], x[1]);  // unrolled, so that the axes stay in registers
    if constexpr (kDimensions > 2) turn_back(bit, x[0], x[2]);
    if constexpr (kDimensions > 3) turn_back(bit, x[0], x[3]);
    if constexpr (kDimensions > 4) turn_back(bit, x[0], x[4]);
    if constexpr (kDimensions > 5) turn_back(bit, x[0], x[5]);
  }
  for (int i = 1; i < kDimensions; ++i) x[i] ^= x[i - 1];
  std::uint32_t parity = x[kDimensions - 1] >> 1;  // of the last axis's bits above each bit
  for (std::uint32_t shift = 1; shift < 32; shift *= 2) parity ^= parity >> shift;
  for (int i = 0; i < kDimensions; ++i) x[i] ^= parity;
  return morton_place(cell);
}

}  // namespace raysheaf
