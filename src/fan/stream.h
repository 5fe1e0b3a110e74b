// Triangles on their way down the cells: bound with triangle.
#pragma once

#include <cstdint>
#include <vector>

#include "fan/cells.h"
#include "intersect/intersect_list.h"
#include "object/triangle_source.h"

namespace raysheaf {

/// A triangle whose rectangle a tile's overlaps.
struct FanPair {
  std::uint32_t tile, triangle;
};

/// What a block of consecutive triangles met.
struct FanBlock {
  std::vector<FanPair> pairs;             ///< by triangle
  std::vector<std::uint32_t> tile_pairs;  ///< how many, by tile
  std::uint64_t bound_tests = 0;
};

/// Triangles [begin, end) against faces, grid cells, groups and tiles. O(triangles + pairs).
void fan_stream(const FanCells& cells, const TriangleSource& source, std::uint32_t begin,
                std::uint32_t end, FanBlock* block);

/// What a tile's triangles did.
struct FanTileCounts {
  std::uint64_t bound_tests = 0, triangle_tests = 0;
};

struct FanTileTask {
  const FanCells& cells;
  const TriangleSource& source;
  Facing facing;
  View<std::uint8_t> occluded;
  View<float> ray_tests;  ///< may be empty
};

/// The triangles of one tile against its packets and rays.
FanTileCounts fan_tile(const FanTileTask& task, std::uint32_t tile, View<const std::uint32_t> ids);

}  // namespace raysheaf
