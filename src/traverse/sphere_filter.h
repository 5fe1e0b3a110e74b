// One node of the ray hierarchy against many balls: the SIMD kernel of the traversal.
#pragma once

#include <cstdint>

#include "traverse/cone_sphere_body.h"

namespace raysheaf {

/// Balls in four arrays: centre x, y, z and radius.
struct SphereArrays {
  const float* x = nullptr;
  const float* y = nullptr;
  const float* z = nullptr;
  const float* radius = nullptr;
};

/// Writes the numbers (from 0) of the balls that `meets` accepts, ascending, and returns how many
/// there are. `out` has room for `count` rounded up to 16. The same answers on every SIMD target.
std::uint32_t filter_spheres(const ConeSphereTest& node, const SphereArrays& spheres,
                             std::uint32_t count, std::uint32_t* out);

/// out[i] = from[index[i]].
void gather_floats(const float* from, const std::uint32_t* index, std::uint32_t count, float* out);

}  // namespace raysheaf
