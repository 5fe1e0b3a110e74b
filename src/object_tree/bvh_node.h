// A node of the trees over triangles that the CPU builds: eight boxes in rows, one SIMD register
// or two a row.
#pragma once

#include <cstdint>

#include "base/aligned.h"
#include "base/vec.h"

namespace raysheaf {

inline constexpr std::uint32_t kBvhWidth = 8;

/// Children [0, children); boxes contain all corners of the triangles below exactly.
struct alignas(kCacheLineBytes) BvhNode {
  float bound[6][kBvhWidth];  ///< rows: min x, y, z, max x, y, z
  std::uint32_t
      first[kBvhWidth];           ///< for a leaf, where its triangles begin; for a node, its number
  std::uint8_t count[kBvhWidth];  ///< triangles of a leaf, at most as its tree says; 0: a node
  std::uint32_t children;

  [[nodiscard]] RAYSHEAF_HD bool is_leaf(std::uint32_t child) const { return count[child] != 0; }
  [[nodiscard]] RAYSHEAF_HD Box box(std::uint32_t child) const {
    return {{bound[0][child], bound[1][child], bound[2][child]},
            {bound[3][child], bound[4][child], bound[5][child]}};
  }
  RAYSHEAF_HD void set_box(std::uint32_t child, const Box& box) {
    for (int axis = 0; axis < 3; ++axis) {
      bound[axis][child] = component(box.min, axis);
      bound[3 + axis][child] = component(box.max, axis);
    }
  }
};
static_assert(sizeof(BvhNode) == 256);

}  // namespace raysheaf
