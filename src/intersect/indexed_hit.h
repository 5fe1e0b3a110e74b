// A hit inside the library: `Hit` with the triangle's number instead of the three ids; and the
// order of hits.
#pragma once

#include <cstdint>
#include <limits>
#include <tuple>

#include "raysheaf/types.h"

namespace raysheaf {

/// A hit, with the triangle's number; `u` and `v` are the weights of the second and third corner.
struct IndexedHit {
  float t = std::numeric_limits<float>::infinity();
  float u = 0, v = 0;
  std::uint32_t triangle = kInvalidId;
};

/// Whether a hit of a ray comes before another. `Hit{}` comes after all.
[[nodiscard]] inline bool is_before(const Hit& a, const Hit& b) {
  return std::tie(a.t, a.geom_id, a.inst_id, a.prim_id) <
         std::tie(b.t, b.geom_id, b.inst_id, b.prim_id);
}

}  // namespace raysheaf
