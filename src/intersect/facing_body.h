// From which sides a ray may hit a triangle.
#pragma once

#include "intersect/intersect_list.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// The order of the corners determines `front`; a mirroring transform reverses it.
RAYSHEAF_HD inline bool shows(Facing facing, std::uint8_t flags, bool front) {
  if (facing == Facing::kBoth || (flags & kSingleSided) == 0) return true;
  return front != ((flags & kMirrored) != 0);
}

}  // namespace raysheaf
