// A hit inside the library: `Hit` with the triangle's number instead of the three ids.
#pragma once

#include <cstdint>
#include <limits>

#include "raysheaf/types.h"

namespace raysheaf {

/// A hit, with the triangle's number; `u` and `v` are the weights of the second and third corner.
struct IndexedHit {
  float t = std::numeric_limits<float>::infinity();
  float u = 0, v = 0;
  std::uint32_t triangle = kInvalidId;
};

}  // namespace raysheaf
