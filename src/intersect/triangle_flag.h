// The flags of a triangle that its hits depend on.
#pragma once

#include <cstdint>

namespace raysheaf {

enum TriangleFlag : std::uint8_t {
  kSingleSided = 1,  ///< its material does not show back faces
  kMirrored = 2,     ///< its instance mirrors: the front is clockwise
};

}  // namespace raysheaf
