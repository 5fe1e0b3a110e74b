// The 32-bit keys by which `crsh` orders rays.
//
//   shadow        31 .......... 2k+L-1 ...... 2k 2k-1 .................. 0
//                 |     0      | light, L bits  | cell of the direction   |
//
//   reflection,   31 30 29 ............................................. 0
//   refraction    | 0  | u5 v5 x5 y5 z5 u4 v4 x4 y4 z4 ... u0 v0 x0 y0 z0 |
//
// The paper's hash (Reis, Costa, Pereira 2017, section 3.2) puts the light's index above the
// spherical direction of a shadow ray, and combines origin and direction for other rays. Its
// azimuth and polar angle have a seam and two poles, and their concatenation makes long thin cells.
// Here the octahedral map unfolds the sphere to a square, and a Hilbert curve traverses the square,
// so that equal keys are compact cells and successive keys are neighbours. The light's index has L
// = bits_for(lights) bits, and k is kDirectionBits, or less if the lights leave less. The second
// key interleaves six bits each of the direction (u, v) and of the origin in the scene's box (x, y,
// z).
#pragma once

#include <cmath>
#include <cstdint>

#include "base/bits.h"
#include "base/vec.h"
#include "rays/ray_place_body.h"

namespace raysheaf {

inline constexpr std::uint32_t kDirectionBits = 8;
inline constexpr std::uint32_t kBounceKeyBits = 30;

/// Maps [0, 1] to one of 2^bits cells; smaller numbers and NaN to the first.
RAYSHEAF_HD inline std::uint32_t quantized(float x, std::uint32_t bits) {
  const float cells = static_cast<float>(1u << bits);
  return x > 0 ? static_cast<std::uint32_t>(clamp(x * cells, 0, cells - 1)) : 0;
}

/// The position of cell (x, y) of a square with 2^bits cells per side along the Hilbert curve
/// (Hilbert 1891).
RAYSHEAF_HD inline std::uint32_t hilbert_2(std::uint32_t x, std::uint32_t y, std::uint32_t bits) {
  std::uint32_t place = 0;
  for (std::uint32_t bit = bits; bit-- > 0;) {
    const std::uint32_t side = 1u << bit, mask = side - 1;
    const std::uint32_t right = (x >> bit) & 1u, upper = (y >> bit) & 1u;
    place = (place << 2) | ((3u * right) ^ upper);
    x &= mask;
    y &= mask;
    if (upper == 0) {
      if (right != 0) {
        x = mask - x;
        y = mask - y;
      }
      const std::uint32_t swapped = x;
      x = y;
      y = swapped;
    }
  }
  return place;
}

/// The layout of a shadow key for a number of lights.
struct ShadowKeyLayout {
  std::uint32_t light_bits = 0, direction_bits = kDirectionBits;
  [[nodiscard]] RAYSHEAF_HD std::uint32_t key_bits() const {
    return light_bits + 2 * direction_bits;
  }
};

RAYSHEAF_HD inline ShadowKeyLayout shadow_key_layout(std::uint32_t lights) {
  ShadowKeyLayout layout;
  layout.light_bits = bits_for(lights);
  const std::uint32_t room = (32 - layout.light_bits) / 2;
  layout.direction_bits = room < kDirectionBits ? room : kDirectionBits;
  return layout;
}

/// `place` on the unit square: octahedral(direction), or the start point of a ray of a directional
/// light.
RAYSHEAF_HD inline std::uint32_t shadow_key(const ShadowKeyLayout& layout, std::uint32_t light,
                                            Vec2 place) {
  const std::uint32_t bits = layout.direction_bits;
  const std::uint32_t cell = hilbert_2(quantized(place.x, bits), quantized(place.y, bits), bits);
  return layout.light_bits == 0 ? cell : (light << (2 * bits)) | cell;
}

/// Six bits spread apart, with four zeros above each.
RAYSHEAF_HD inline std::uint32_t spread_by_5(std::uint32_t x) {
  std::uint32_t spread = 0;
  for (std::uint32_t bit = 0; bit < 6; ++bit) spread |= ((x >> bit) & 1u) << (5 * bit);
  return spread;
}

/// `box`: of the scene; an axis without extent gives 0.
RAYSHEAF_HD inline std::uint32_t bounce_key(const Box& box, Vec3 origin, Vec3 direction) {
  const Vec3 extent = box.max - box.min, from = origin - box.min;
  const std::uint32_t x = extent.x > 0 ? quantized(from.x / extent.x, 6) : 0;
  const std::uint32_t y = extent.y > 0 ? quantized(from.y / extent.y, 6) : 0;
  const std::uint32_t z = extent.z > 0 ? quantized(from.z / extent.z, 6) : 0;
  const Vec2 square = octahedral(direction);
  const std::uint32_t u = quantized(square.x, 6), v = quantized(square.y, 6);
  return (spread_by_5(u) << 4) | (spread_by_5(v) << 3) | (spread_by_5(x) << 2) |
         (spread_by_5(y) << 1) | spread_by_5(z);
}

}  // namespace raysheaf
