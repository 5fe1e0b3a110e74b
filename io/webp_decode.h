// WebP by libwebp, if the build has it: still images, no animations.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "io/image.h"

namespace raysheaf::io {

/// Whether this build reads WebP.
[[nodiscard]] bool reads_webp();

/// Whether the file is WebP; always false if this build does not read it.
[[nodiscard]] bool is_webp(std::span<const std::uint8_t> encoded);

/// The size in the header. Nothing without a valid header, or for an animation.
[[nodiscard]] std::optional<ImageSize> webp_size(std::span<const std::uint8_t> encoded);

/// RGBA, or nothing if the file is damaged or truncated. Throws `std::bad_alloc`. `size` is what
/// `webp_size` returned.
[[nodiscard]] std::optional<Image> decode_webp(std::span<const std::uint8_t> encoded,
                                               ImageSize size);

}  // namespace raysheaf::io
