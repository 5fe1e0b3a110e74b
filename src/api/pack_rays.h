// Packs rays from separate arrays.
#pragma once

#include "raysheaf/types.h"

namespace raysheaf {

/// Writes rays [begin, end) of `parts` to `out`. Numbers outside float's range become infinite.
void pack_rays(const RayParts& parts, std::size_t begin, std::size_t end, Ray* out);

}  // namespace raysheaf
