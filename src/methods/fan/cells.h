// The rays of a fan in sorted order, and the cells over them.
//
//   rays of a face, along a Hilbert curve      . . . . | . . . . | . . . . | . . . .
//   bundle: 16 of them                         +-----+   +-----+   +-----+   +-----+
//   tile:   16 bundles                         +---------------+   +---------------+
//   group:  16 tiles                           +-----------------------------------+
//
// A bound is the tight rectangle of its rays' shears, and the farthest reach of its rays along the
// face's axis. In addition to this tree, each face has a pyramid of square grids: the cells under a
// triangle's rectangle tell which tiles have rays there and how far the rays reach.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/buffer.h"
#include "base/vec.h"
#include "base/view.h"
#include "exec/executor.h"

namespace raysheaf {

inline constexpr std::uint32_t kFanFaces = 6;
inline constexpr std::uint32_t kBundleSlots = 16;  ///< rays per bundle
inline constexpr std::uint32_t kTileBundles = 16;
inline constexpr std::uint32_t kTileSlots = kBundleSlots * kTileBundles;
inline constexpr std::uint32_t kGroupTiles = 16;

/// The axes of a face as `make_ray_setup` numbers them; rays point along sign * z.
struct FanFace {
  std::uint32_t x, y, z;
  float sign;
};

inline FanFace fan_face(std::uint32_t face) {
  const std::uint32_t z = face / 2, x = (z + 1) % 3, y = (z + 2) % 3;
  if (face % 2 == 0) return {x, y, z, 1};
  return {y, x, z, -1};
}

/// The bound of some rays of a face; empty by default.
struct FanBound {
  float u0 = std::numeric_limits<float>::infinity(), u1 = -u0;
  float v0 = u0, v1 = -u0;
  float reach = -u0;

  void include(const FanBound& other) {
    u0 = std::min(u0, other.u0), u1 = std::max(u1, other.u1);
    v0 = std::min(v0, other.v0), v1 = std::max(v1, other.v1);
    reach = std::max(reach, other.reach);
  }
};

/// Bounds in columns, for SIMD.
struct FanBounds {
  Buffer<float> u0, u1, v0, v1, reach;

  void resize(std::size_t count) {
    for (Buffer<float>* column : {&u0, &u1, &v0, &v1, &reach}) column->resize_uninitialized(count);
  }
  void set(std::size_t i, const FanBound& b) const {
    u0[i] = b.u0, u1[i] = b.u1, v0[i] = b.v0, v1[i] = b.v1, reach[i] = b.reach;
  }
  [[nodiscard]] FanBound at(std::size_t i) const { return {u0[i], u1[i], v0[i], v1[i], reach[i]}; }
  [[nodiscard]] std::size_t bytes() const { return 5 * u0.capacity_bytes(); }
};

/// Properties of all rays, computed with the keys.
struct FanRange {
  bool one_origin = true;   ///< bit for bit; otherwise the keys are not used
  bool forward = true;      ///< no t_min is negative
  float largest_along = 0;  ///< of |direction| along the dominant axis

  void include(const FanRange& other) {
    one_origin = one_origin && other.one_origin;
    forward = forward && other.forward;
    largest_along = std::max(largest_along, other.largest_along);
  }
};

struct FanRays {
  Buffer<float> shear_x, shear_y, shear_z, t_min, t_max;
  Buffer<float> reach;        ///< along the face's axis, rounded up
  Buffer<std::uint32_t> ray;  ///< its number; undefined in slots without a ray

  void resize(std::size_t count) {
    for (Buffer<float>* column : {&shear_x, &shear_y, &shear_z, &t_min, &t_max, &reach})
      column->resize_uninitialized(count);
    ray.resize_uninitialized(count);
  }
};

/// A cell of a grid: the tiles [first, last] contain its rays; empty if first > last.
struct FanCell {
  float reach = -std::numeric_limits<float>::infinity();
  std::uint32_t first = 0xffffffffu, last = 0;

  void include(const FanCell& other) {
    reach = std::max(reach, other.reach);
    first = std::min(first, other.first), last = std::max(last, other.last);
  }
};

struct FanFaceRays {
  std::uint32_t first_ray = 0, ray_count = 0;  ///< in sorted order
  std::uint32_t first_tile = 0, tile_count = 0;
  FanBound bound;
};

struct FanCells {
  Vec3 origin;
  std::uint32_t axis_bits = 0;  ///< of the keys' coordinates
  std::uint32_t level = 0;      ///< the finest grid has 2^level by 2^level cells per face
  /// If all corners of a triangle lie this far behind the origin along a face's axis, its hits have
  /// t < 0, which no ray allows; infinite if some ray allows it.
  float behind = std::numeric_limits<float>::infinity();
  std::uint32_t tile_count = 0, live_rays = 0;
  FanFaceRays faces[kFanFaces];
  std::vector<std::uint8_t> face_of_tile;
  std::vector<std::uint32_t> rays_of_tile;
  FanRays rays;  ///< kTileSlots per tile
  FanBounds bundles, tiles, groups;
  Buffer<FanCell> cells;  ///< all levels, the coarsest first
  Buffer<std::uint32_t> keys, counters, order;

  /// The index in `cells` of a level's cell.
  [[nodiscard]] static std::size_t cell_at(std::uint32_t level, std::uint32_t face, std::uint32_t x,
                                           std::uint32_t y) {
    const std::size_t before = 2 * ((std::size_t{1} << 2 * level) - 1);
    return before + ((((std::size_t{face} << level) | y) << level) | x);
  }
};

/// Sorts the rays and bounds them; returns false if they do not share one origin. O(rays).
[[nodiscard]] bool make_cells(const Executor& executor, View<const Ray> rays, FanCells* cells);

/// The SIMD parts, chosen at run time. Keys of rays [begin, end): face | Hilbert; kDeadFace for
/// rays that cannot hit anything. Compares their origins with that of rays[0].
inline constexpr std::uint32_t kDeadFace = 6;
void fan_keys(const Ray* rays, std::size_t begin, std::size_t end, std::uint32_t axis_bits,
              std::uint32_t* keys, FanRange* range);

/// The cells at the ends of a run of tiles, which the neighbouring runs may share.
struct FanSeam {
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t at[2] = {kNone, kNone};
  FanCell cell[2];
};

/// Fills slots, bundles and tiles of [begin_tile, end_tile), and their cells of the finest grid.
void fan_gather(const Ray* rays, FanCells* cells, std::uint32_t begin_tile, std::uint32_t end_tile,
                FanSeam* seam);

}  // namespace raysheaf
