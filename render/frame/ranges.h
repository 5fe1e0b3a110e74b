// Valid ranges of options, for the renderer and the laboratory.
#pragma once

#include <cstdint>
#include <string>

#include "raysheaf/error.h"

namespace raysheaf {

inline constexpr std::uint32_t kLargestSide = 16384;  ///< of an image, in pixels

/// Throws `Error` (kInvalidArgument) naming the field.
inline void check_range(const char* field, std::uint32_t value, std::uint32_t least,
                        std::uint32_t most) {
  if (value < least || value > most)
    throw Error(ErrorCode::kInvalidArgument,
                "must be from " + std::to_string(least) + " to " + std::to_string(most) + ", not " +
                    std::to_string(value),
                field);
}

/// The same for the ray hierarchy's settings in `MethodSettings`.
inline void check_hierarchy(std::uint32_t levels, std::uint32_t branching, std::uint32_t key_bits) {
  check_range("levels", levels, 1, 8);
  check_range("branching", branching, 2, 64);
  if (key_bits != 32 && key_bits != 64)
    throw Error(ErrorCode::kInvalidArgument, "must be 32 or 64", "key_bits");
}

}  // namespace raysheaf
