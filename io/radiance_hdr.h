// Radiance's picture format (.hdr): red, green and blue with an exponent that they share.
#pragma once

#include <span>
#include <string>

#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// The picture in `file` as an environment's map. G. Ward, "Real Pixels", Graphics Gems II, 1991;
/// runs as in Radiance's color.c, both old and new. stb_image reads the format too, but takes what
/// is cut off for black. Throws `Error` (kInvalidData, kUnsupported, kOutOfMemory) whose place is
/// `path`, with what is wrong and where.
[[nodiscard]] Environment decode_radiance_hdr(std::span<const std::uint8_t> file,
                                              const std::string& path);

}  // namespace raysheaf::io
