// OpenEXR images as textures, with linear numbers converted to 8 bits per channel.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "io/image.h"

namespace raysheaf::io {

[[nodiscard]] bool is_exr(std::span<const std::uint8_t> encoded);

/// The size in the header. Nothing if there is none, or the file has several parts or deep pixels.
[[nodiscard]] std::optional<ImageSize> exr_size(std::span<const std::uint8_t> encoded);

struct ExrImage {
  Image image;
  bool exceeds_one = false;  ///< some values exceeded 1 and were clamped
};
/// Reads the channels R, G, B and A (1 if missing); a single channel is grey. Data stays linear.
/// Colours are encoded in sRGB, as in other images, and not premultiplied. Negative and non-finite
/// values become 0. Nothing if the file is damaged or has none of these channels.
[[nodiscard]] std::optional<ExrImage> decode_exr_image(std::span<const std::uint8_t> encoded,
                                                       bool is_data);

}  // namespace raysheaf::io
