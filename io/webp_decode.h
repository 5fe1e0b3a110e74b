// WebP by libwebp, where the build has it: pictures, not films.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "io/image.h"

namespace raysheaf::io {

/// Whether this build reads them.
[[nodiscard]] bool reads_webp();

/// Whether it is one, as a build that reads them sees it.
[[nodiscard]] bool is_webp(std::span<const std::uint8_t> encoded);

/// What its head says, or nothing where it has none or is a film.
[[nodiscard]] std::optional<ImageSize> webp_size(std::span<const std::uint8_t> encoded);

/// RGBA, or nothing where it is damaged or cut short. Throws `std::bad_alloc`. `size` is what
/// `webp_size` says, and accepted.
[[nodiscard]] std::optional<Image> decode_webp(std::span<const std::uint8_t> encoded,
                                               ImageSize size);

}  // namespace raysheaf::io
