// Flat arrays of triangles as the paper's methods read them (paper/base/flat_arrays.h holds them).
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/vec.h"

namespace raysheaf {

inline constexpr std::uint32_t kTriangleBlock = 16;

/// The sum of this and any other radius is negative.
inline constexpr float kPaddingRadius = -1e30f;

/// Read-only pointers to the arrays that traversal and intersection read.
struct TriangleView {
  std::uint32_t count = 0;      ///< without padding
  const float* vertex[3][3]{};  ///< [corner][axis]
  const float* sphere[4]{};     ///< centre x, y, z and radius
  const std::uint8_t* flags{};  ///< TriangleFlag
  Box bounds;                   ///< of all corners

  [[nodiscard]] Vec3 corner(std::size_t triangle, int k) const {
    return {vertex[k][0][triangle], vertex[k][1][triangle], vertex[k][2][triangle]};
  }
};

}  // namespace raysheaf
