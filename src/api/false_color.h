// A colour scale whose lightness grows evenly from dark violet through green to light yellow, so
// that equal steps of the value look equal, in grey too and to most colour-blind eyes.
#pragma once

#include <array>
#include <cstdint>

namespace raysheaf {

/// `t` in [0, 1], clamped; a NaN is 0. sRGB.
[[nodiscard]] std::array<std::uint8_t, 3> false_color(float t);

}  // namespace raysheaf
