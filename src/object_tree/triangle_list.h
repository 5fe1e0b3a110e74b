// Triangles in a device's format.
#pragma once

#include <cstdint>

#include "base/view.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// Corners, three per triangle, by the triangles' numbers, and TriangleFlags, or none.
struct TriangleList {
  View<const Vec3> corners;
  View<const std::uint8_t> flags;

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(corners.size / 3); }
};

}  // namespace raysheaf
