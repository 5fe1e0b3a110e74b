// OpenEXR images as textures, with linear numbers converted to 8 bits per channel, and as
// environments.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "io/image.h"

namespace raysheaf::io {

[[nodiscard]] bool is_exr(std::span<const std::uint8_t> encoded);

/// The size in the header. Nothing if the file has no part that the functions below read.
[[nodiscard]] std::optional<ImageSize> exr_size(std::span<const std::uint8_t> encoded);

// Both functions read the first part that is not deep: tiled or in scan lines, with any compression
// of OpenEXR 3.1. They read its channels R, G, B and A (1 if missing), or those of the first layer
// that has R, G and B. A single channel, with or without A, is grey. They throw `Error`
// (kInvalidData, kUnsupported, kOutOfMemory) without a place, or with `path` as place.

struct ExrImage {
  Image image;
  bool exceeds_one = false;  ///< some values exceeded 1 and were clamped
  std::string remark;        ///< names the layer if it was chosen among several; else empty
};
/// Data stays linear. Colours are encoded in sRGB, as in other images, and not premultiplied.
/// Negative and non-finite values become 0.
[[nodiscard]] ExrImage decode_exr_image(std::span<const std::uint8_t> encoded, bool is_data);

/// Radiance as it is stored: also negative and not finite.
[[nodiscard]] Environment decode_exr_environment(std::span<const std::uint8_t> file,
                                                 const std::string& path);

}  // namespace raysheaf::io
