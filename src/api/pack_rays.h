// Rays from their parts.
#pragma once

#include "raysheaf/ray_parts.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// Rays [begin, end) of `parts`, to `out`. Numbers that float has no room for become infinite.
void pack_rays(const RayParts& parts, std::size_t begin, std::size_t end, Ray* out);

}  // namespace raysheaf
