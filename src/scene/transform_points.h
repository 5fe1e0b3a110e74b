// Transforms vertices to world space.
#pragma once

#include <cstddef>

#include "raysheaf/types.h"

namespace raysheaf {

/// The largest world coordinate, so that no squared distance overflows.
inline constexpr float kLargestCoordinate = 1e18f;

/// to[i] = `transform_point(to_world, from[i])`, bit for bit. Returns whether all coordinates are
/// numbers and within `kLargestCoordinate`. `to` must not be `from`.
bool transform_points(const Affine& to_world, const Vec3* from, std::size_t count, Vec3* to);

}  // namespace raysheaf
