// Images in OpenEXR as textures: eight bits a part of their linear numbers.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "io/image.h"

namespace raysheaf::io {

[[nodiscard]] bool is_exr(std::span<const std::uint8_t> encoded);

/// What its head says, or nothing where it has none, or several parts or deep pixels.
[[nodiscard]] std::optional<ImageSize> exr_size(std::span<const std::uint8_t> encoded);

struct ExrImage {
  Image image;
  bool exceeds_one = false;  ///< parts that did are 1
};
/// Its channels R, G, B and A (1 where it has none); one that is alone is grey. As data, linear; as
/// colours, encoded in sRGB as other images are, and not premultiplied. What is not finite or below
/// 0 is 0. Nothing where it is damaged or has none of these channels.
[[nodiscard]] std::optional<ExrImage> decode_exr_image(std::span<const std::uint8_t> encoded,
                                                       bool is_data);

}  // namespace raysheaf::io
