// Which sides of a triangle a ray may meet.
#pragma once

#include "intersect/intersect_list.h"
#include "intersect/triangle_view.h"

namespace raysheaf {

/// `front` is told by the order of the corners, which a mirroring transform turns.
RAYSHEAF_HD inline bool shows(Facing facing, std::uint8_t flags, bool front) {
  if (facing == Facing::kBoth || (flags & kSingleSided) == 0) return true;
  return front != ((flags & kMirrored) != 0);
}

}  // namespace raysheaf
