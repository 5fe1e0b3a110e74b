#include "nearest/inside.h"

#include "nearest/tile_order.h"

namespace raysheaf {
namespace {

struct InsideRoom {
  std::vector<std::uint8_t> inside;
  std::vector<std::uint32_t> stack = std::vector<std::uint32_t>(64);
};

}  // namespace

void find_inside(const Executor& executor, const NearestScene& scene, const PointSource& points,
                 InsideRule rule, bool closed, View<std::uint8_t> inside) {
  for_each_tile<InsideRoom>(
      executor, points, scene.worlds, kMostTilePoints,
      [&](const TilePoints& tile, InsideRoom* room) {
        find_inside({&scene, rule, closed, static_cast<std::uint32_t>(tile.begin), tile.points.data,
                     tile.order.data(), tile.count(), nullptr, 0, inside.data + tile.begin,
                     &room->stack, &executor});
      });
}

void find_signed_distances(const Executor& executor, const NearestScene& scene,
                           const PointSource& points, InsideRule rule, bool closed,
                           View<double> distances) {
  const double slack = slack_of(scene);
  find_nearest(executor, scene, points, 1, [&](const NearestTile& tile) {
    InsideRoom room;
    const std::size_t count = tile.points.size;
    room.inside.resize(count);
    find_inside({&scene, rule, closed, static_cast<std::uint32_t>(tile.begin), tile.points.data,
                 tile.order, static_cast<std::uint32_t>(count), tile.found.data, slack,
                 room.inside.data(), &room.stack, &executor});
    for (std::size_t i = 0; i < count; ++i) {
      const double distance = tile.found[i].distance;
      const bool below = room.inside[i] != 0 && distance > 0;
      distances[tile.begin + i] = below ? -distance : distance;
    }
  });
}

}  // namespace raysheaf
