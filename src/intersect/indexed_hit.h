// A hit inside the library: `Hit` with the triangle's number instead of the three ids; and the
// order of hits.
#pragma once

#include <cstdint>
#include <limits>

#include "base/host_device.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// A hit, with the triangle's number; `u` and `v` are the weights of the second and third corner.
struct IndexedHit {
  float t = std::numeric_limits<float>::infinity();
  float u = 0, v = 0;
  std::uint32_t triangle = kInvalidId;
};

/// Whether a hit of a ray comes before another. `Hit{}` comes after all.
[[nodiscard]] RAYSHEAF_HD inline bool is_before(const Hit& a, const Hit& b) {
  if (a.t != b.t) return a.t < b.t;
  if (a.geom_id != b.geom_id) return a.geom_id < b.geom_id;
  return a.inst_id < b.inst_id || (a.inst_id == b.inst_id && a.prim_id < b.prim_id);
}

}  // namespace raysheaf
