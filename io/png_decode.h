// PNG by libpng. Colours are read as stored; gamma and profiles are ignored.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "io/image.h"

namespace raysheaf::io {

[[nodiscard]] bool is_png(std::span<const std::uint8_t> encoded);

/// The size in the header; nothing without a valid header.
[[nodiscard]] std::optional<ImageSize> png_size(std::span<const std::uint8_t> encoded);

/// RGBA with 8 bits per channel (16 bits are rounded), or nothing if the file is damaged. Throws
/// `std::bad_alloc`. `size` is what `png_size` returned.
[[nodiscard]] std::optional<Image> decode_png(std::span<const std::uint8_t> encoded,
                                              ImageSize size);

}  // namespace raysheaf::io
