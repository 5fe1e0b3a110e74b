// The order of a batch's rays: by the quarter of a cube's face towards which they point, as `dual`
// processes them.
//
// Rays of one quarter share the axis along which the ray-triangle test shears them, and the planes
// of a box that they intersect first, so no choice is needed for each lane.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "base/buffer.h"
#include "base/view.h"
#include "exec/bucket_sort.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// Six faces of the cube, four quarters of each.
inline constexpr std::uint32_t kQuarters = 24;

/// 8 * axis, the axis of `make_ray_setup`; plus 4 if the ray points against it, plus 2 and 1 if it
/// points against the next axis and the one after that. Has no branches, because the processor
/// cannot predict the axes of incoherent rays.
[[nodiscard]] inline std::uint32_t quarter_of(Vec3 d) {
  const float x = std::fabs(d.x), y = std::fabs(d.y), z = std::fabs(d.z);
  const std::uint32_t x_or_y = x > y ? 0 : 1, is_either = (x > y ? x : y) > z ? 1 : 0;
  const std::uint32_t axis = 2 - (2 - x_or_y) * is_either;
  const auto sign = [](float v) { return std::bit_cast<std::uint32_t>(v) >> 31; };
  const std::uint32_t signs = 4 * sign(d.x) + 2 * sign(d.y) + sign(d.z);
  return 8 * axis + ((signs << axis | signs >> (3 - axis)) & 7);
}

/// `quarter_of` of each ray's direction, by SIMD. Returns whether all rays have the origin and
/// t_min of `first`, bit for bit.
bool find_quarters(View<const Ray> rays, const Ray& first, std::uint8_t* quarters);

struct RayOrder {
  Buffer<std::uint32_t> rays;                         ///< the caller's numbers, in the new order
  std::array<std::uint32_t, kQuarters + 1> starts{};  ///< of the quarters
  bool one_start = false;  ///< all rays are known to have one origin and one t_min, bit for bit
  Buffer<std::uint8_t> quarters;  ///< scratch
  BucketSort sort;                ///< scratch

  [[nodiscard]] std::size_t bytes() const {
    return rays.capacity_bytes() + quarters.capacity_bytes() + sort.bytes();
  }
};

/// About this many rays, rounded to whole rows of tiles, at least one row.
[[nodiscard]] std::size_t rows_of_tiles(std::size_t rays, std::size_t row);

/// O(rays). Rays of a quarter keep the caller's order. At most 2^31 rays. `row`: if not 0, the
/// number of rays in a row of an image; the order then takes tiles of four rows and four columns,
/// because sixteen rays of a tile are more coherent than sixteen of a row: mirror rays take 1.02 of
/// the time in rows.
void order_rays(const Executor& executor, View<const Ray> rays, RayOrder* order,
                std::size_t row = 0);

}  // namespace raysheaf
