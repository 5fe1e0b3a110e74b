// The packed 8-bit image formats, each in a translation unit of its own: PNG by libpng, colours as
// stored, without gamma and profiles; JPEG by libjpeg-turbo, baseline and progressive, with one,
// three or four components; WebP by libwebp, if the build has it, still images only.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "io/image.h"

namespace raysheaf::io {

/// The most scans of a progressive JPEG: a scan of a few bytes takes the time of all pixels.
/// Encoders write about ten.
inline constexpr int kMostScans = 64;

/// Whether this build reads WebP. If not, `is_webp` is always false.
[[nodiscard]] bool reads_webp();

[[nodiscard]] bool is_png(std::span<const std::uint8_t> encoded);
[[nodiscard]] bool is_jpeg(std::span<const std::uint8_t> encoded);
[[nodiscard]] bool is_webp(std::span<const std::uint8_t> encoded);

// The size in the header; nothing without a valid header, or for an animation. They throw
// `std::bad_alloc`.
[[nodiscard]] std::optional<ImageSize> png_size(std::span<const std::uint8_t> encoded);
[[nodiscard]] std::optional<ImageSize> jpeg_size(std::span<const std::uint8_t> encoded);
[[nodiscard]] std::optional<ImageSize> webp_size(std::span<const std::uint8_t> encoded);

// RGBA with 8 bits per channel (16 bits are rounded), or nothing if the file is damaged or cut
// short. They throw `std::bad_alloc`. `size` is what the function above returned.
[[nodiscard]] std::optional<Image> decode_png(std::span<const std::uint8_t> encoded,
                                              ImageSize size);
[[nodiscard]] std::optional<Image> decode_jpeg(std::span<const std::uint8_t> encoded,
                                               ImageSize size);
[[nodiscard]] std::optional<Image> decode_webp(std::span<const std::uint8_t> encoded,
                                               ImageSize size);

}  // namespace raysheaf::io
