// Triangles on their way down the cells: bound with triangle.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "intersect/intersect_list.h"
#include "methods/fan/cells.h"
#include "object_tree/triangle_source.h"

namespace raysheaf {

/// Corners travel with the number: what is left of the triangles is far smaller than what streamed
/// by, and fetching it again would miss every cache.
struct FanTriangle {
  std::uint32_t id;
  std::array<Vec3, 3> corners;
};

/// A triangle that meets a tile's bound.
struct FanPair {
  std::uint32_t tile;
  FanTriangle triangle;
};

/// What a block of consecutive triangles met.
struct FanBlock {
  std::vector<FanPair> pairs;             ///< by triangle
  std::vector<std::uint32_t> tile_pairs;  ///< how many, by tile
  std::uint64_t most_pairs = 0;           ///< more of them are not worth their memory
  std::uint64_t bound_tests = 0;

  [[nodiscard]] bool is_full() const { return pairs.size() > most_pairs; }
};

/// Triangles [begin, end) against faces, grid cells, groups and tiles, until the block is full.
/// O(triangles + pairs).
void fan_stream(const FanCells& cells, const TriangleSource& source, std::uint32_t begin,
                std::uint32_t end, FanBlock* block);

/// What a tile's triangles did.
struct FanTileCounts {
  std::uint64_t bound_tests = 0, triangle_tests = 0;
};

struct FanTileTask {
  const FanCells& cells;
  const TriangleSource& source;
  View<const Ray> rays;
  Facing facing;
  View<std::uint8_t> occluded;
  View<float> ray_tests;  ///< may be empty
};

/// The triangles of one tile against its bundles and rays.
FanTileCounts fan_tile(const FanTileTask& task, std::uint32_t tile,
                       View<const FanTriangle> triangles);

}  // namespace raysheaf
