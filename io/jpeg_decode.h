// JPEG by libjpeg-turbo: baseline and progressive, with one, three or four components.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "io/image.h"

namespace raysheaf::io {

/// The most scans of a progressive image: a scan of a few bytes takes the time of all pixels.
/// Encoders write about ten.
inline constexpr int kMostScans = 64;

[[nodiscard]] bool is_jpeg(std::span<const std::uint8_t> encoded);

/// The size in the header; nothing without a valid header. Throws `std::bad_alloc`.
[[nodiscard]] std::optional<ImageSize> jpeg_size(std::span<const std::uint8_t> encoded);

/// RGBA, or nothing if the file is damaged or pixels are missing at its end. Throws
/// `std::bad_alloc`. `size` is what `jpeg_size` returned.
[[nodiscard]] std::optional<Image> decode_jpeg(std::span<const std::uint8_t> encoded,
                                               ImageSize size);

}  // namespace raysheaf::io
