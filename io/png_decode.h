// PNG by libpng: its colours as they are stored, without a look at gamma or profiles.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "io/image.h"

namespace raysheaf::io {

[[nodiscard]] bool is_png(std::span<const std::uint8_t> encoded);

/// What its head says, or nothing where it has none.
[[nodiscard]] std::optional<ImageSize> png_size(std::span<const std::uint8_t> encoded);

/// RGBA of 8 bits (16 are rounded), or nothing where it is damaged. Throws `std::bad_alloc`.
/// `size` is what `png_size` says, and accepted.
[[nodiscard]] std::optional<Image> decode_png(std::span<const std::uint8_t> encoded,
                                              ImageSize size);

}  // namespace raysheaf::io
