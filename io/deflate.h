// Compression for pictures that are written frame after frame.
#pragma once

#include <cstdint>
#include <span>

#include "io/file.h"

namespace raysheaf::io {

/// A zlib stream (RFC 1950) of the bytes, fewer than 2^31. O(bytes): one look for a repetition at
/// each place, and codes that fit the symbols of each block.
[[nodiscard]] Bytes zlib_compressed(std::span<const std::uint8_t> bytes);

}  // namespace raysheaf::io
