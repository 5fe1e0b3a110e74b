// The points of a tile, world by world, and those of each along a Morton curve (Morton 1966):
// neighbours follow each other.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "nearest/nearest.h"

namespace raysheaf {

inline constexpr std::uint32_t kTileBits = 17, kMostTilePoints = 1u << kTileBits;

/// Writes the numbers of the points, `count` of at most kMostTilePoints, in the low kTileBits bits
/// of `order`, below their keys. `worlds`: points[0] is its first item. `spare` is as long.
void order_tile(const QueryPoint* points, const ItemWorlds& worlds, std::uint32_t count,
                std::uint64_t* order, std::uint64_t* spare);

/// Points in their order, and room for it.
struct TilePoints {
  std::size_t begin = 0;
  View<const QueryPoint> points;
  Buffer<QueryPoint> room;
  std::vector<std::uint64_t> order, spare;

  void take(const PointSource& source, const ItemWorlds& worlds, std::size_t first,
            std::size_t end) {
    begin = first;
    room.resize_uninitialized(end - first);
    points = source.take(first, end, room.data());
    order.resize(end - first);
    spare.resize(end - first);
    order_tile(points.data, worlds.from(first), count(), order.data(), spare.data());
  }
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(points.size); }
};

/// Calls `body(tile, room)` for tiles of at most `most` points that make up all; a thread has one
/// `Room`.
template <class Room, class Body>
void for_each_tile(const Executor& executor, const PointSource& points, const ItemWorlds& worlds,
                   std::size_t most, const Body& body) {
  // As many as leave each thread some tiles, and no fewer points than pay for their order. The
  // larger a tile, the nearer to each other are neighbours in its order.
  constexpr std::size_t kTilesAThread = 4, kLeastPoints = 256;
  const std::size_t wanted = points.size() / (kTilesAThread * executor.threads());
  most = std::clamp<std::size_t>(most, 1, kMostTilePoints);
  const std::size_t size = std::clamp(wanted, std::min(kLeastPoints, most), most);
  executor.for_each_block(
      (points.size() + size - 1) / size, 1, [&](std::size_t first, std::size_t last) {
        TilePoints tile;
        Room room;
        for (std::size_t t = first; t < last; ++t) {
          tile.take(points, worlds, t * size, std::min(points.size(), (t + 1) * size));
          body(tile, &room);
        }
      });
}

}  // namespace raysheaf
