// Tests one ray with many triangles: the SIMD kernel of the final tests and of brute force.
#pragma once

#include <cstdint>

#include "intersect/triangle_body.h"

namespace raysheaf {

/// Corners in nine arrays, [corner][axis]. The number of triangle i is `ids[i]`, or `first_id + i`
/// if `ids` is null; `flags` (TriangleFlag) is indexed by that number and may be null.
struct TriangleArrays {
  const float* vertex[3][3]{};
  const std::uint32_t* ids = nullptr;
  std::uint32_t first_id = 0;
  std::uint32_t count = 0;
  const std::uint8_t* flags = nullptr;
};

/// The best hit so far: the least (t, triangle).
struct RayHit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t triangle = kInvalidId;

  [[nodiscard]] RAYSHEAF_HD bool found() const { return triangle != kInvalidId; }
  RAYSHEAF_HD void take(float other_t, std::uint32_t other) {
    if (other_t < t || (other_t == t && other < triangle)) {
      t = other_t;
      triangle = other;
    }
  }
};

/// Which sides of triangles are skipped: none, or the back of single-sided ones.
enum class Facing : std::uint8_t { kBoth, kSkipBackOfSingleSided };

/// Updates `best` with every hit among the triangles. The result is the same on every SIMD target
/// and in any order.
void intersect_list(const RaySetup& ray, const TriangleArrays& triangles, Facing facing,
                    RayHit* best);

}  // namespace raysheaf
