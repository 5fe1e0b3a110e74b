// Radiance's image format (.hdr): red, green and blue with a shared exponent.
#pragma once

#include <span>
#include <string>

#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// Decodes the image in `file` as an environment map. G. Ward, "Real Pixels", Graphics Gems II,
/// 1991; run-length encoding as in Radiance's color.c, both old and new. stb_image reads the format
/// too, but silently fills truncated images with black. An image may be stored in any of the eight
/// orientations. Values beyond float become infinite. Throws `Error` (kInvalidData, kUnsupported,
/// kOutOfMemory) whose place is `path`; the message says what is wrong and where.
[[nodiscard]] Environment decode_radiance_hdr(std::span<const std::uint8_t> file,
                                              const std::string& path);

}  // namespace raysheaf::io
