// JPEG by libjpeg-turbo: baseline and progressive, of one, three or four components.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "io/image.h"

namespace raysheaf::io {

/// A progressive picture may have this many scans: each takes the time of all pixels, and a few
/// bytes. Encoders write ten.
inline constexpr int kMostScans = 64;

[[nodiscard]] bool is_jpeg(std::span<const std::uint8_t> encoded);

/// What its head says, or nothing where it has none. Throws `std::bad_alloc`.
[[nodiscard]] std::optional<ImageSize> jpeg_size(std::span<const std::uint8_t> encoded);

/// RGBA, or nothing where it is damaged or cut short so that pixels are missing. Throws
/// `std::bad_alloc`. `size` is what `jpeg_size` says, and accepted.
[[nodiscard]] std::optional<Image> decode_jpeg(std::span<const std::uint8_t> encoded,
                                               ImageSize size);

}  // namespace raysheaf::io
