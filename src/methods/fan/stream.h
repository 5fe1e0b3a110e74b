// Streams triangles down the cells, testing bounds with triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "intersect/intersect_list.h"
#include "methods/fan/cells.h"
#include "scene/triangle_source.h"

namespace raysheaf {

/// Stores the corners with the number: the remaining triangles are far smaller than all that
/// streamed, and fetching them again would miss every cache.
struct FanTriangle {
  std::uint32_t id;
  std::array<Vec3, 3> corners;
};

/// A triangle that overlaps a tile's bound.
struct FanPair {
  std::uint32_t tile;
  FanTriangle triangle;
};

/// The results of a block of consecutive triangles.
struct FanBlock {
  std::vector<FanPair> pairs;             ///< sorted by triangle
  std::vector<std::uint32_t> tile_pairs;  ///< their number, for each tile
  std::uint64_t most_pairs = 0;           ///< the limit, beyond which the pairs need too much
                                          ///< memory
  std::uint64_t bound_tests = 0;

  [[nodiscard]] bool is_full() const { return pairs.size() > most_pairs; }
};

/// Tests triangles [begin, end) with faces, grid cells, groups and tiles, until the block is full.
/// O(triangles + pairs).
void fan_stream(const FanCells& cells, const TriangleSource& source, std::uint32_t begin,
                std::uint32_t end, FanBlock* block);

/// Counts of a tile's triangles.
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

/// Tests the triangles of one tile with its bundles and rays.
FanTileCounts fan_tile(const FanTileTask& task, std::uint32_t tile,
                       View<const FanTriangle> triangles);

}  // namespace raysheaf
