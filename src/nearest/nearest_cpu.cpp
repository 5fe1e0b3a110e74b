#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/vec.h"
#include "nearest/nearest.h"
#include "nearest/nearest_kernel.h"
#include "nearest/tile_order.h"

namespace raysheaf {
namespace {

/// Triangles that a tile's points find, at most.
constexpr std::size_t kMostTileFound = std::size_t{1} << 18;

struct NearestRoom {
  std::vector<FoundTriangle> found;
  std::vector<NearestStop> stack = std::vector<NearestStop>(64);
};

}  // namespace

void build_thin_tree(const Executor& executor, const TriangleSource& source, const ObjectTree& tree,
                     ObjectTree* thin) {
  std::vector<std::uint32_t> numbers = tree.left_out;
  std::mutex mutex;
  executor.for_each_block(tree.quads.size(), kCopyGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> here;
    for (std::size_t q = begin; q < end; ++q)
      for (std::uint32_t lane = 0; lane < kQuadTriangles; ++lane)
        if (is_point(tree.quads[q], lane)) here.push_back(tree.quads[q].id[lane]);
    if (here.empty()) return;
    const std::lock_guard lock(mutex);
    numbers.insert(numbers.end(), here.begin(), here.end());
  });
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  build_object_tree_of(executor, source, numbers, thin);
}

double slack_of(const NearestScene& scene) {
  const auto largest = [](const Box& box) {
    return std::max(max_component(abs(box.min)), max_component(abs(box.max)));
  };
  const double most = largest(scene.bounds());
  const bool has_thin = scene.levels == nullptr && !scene.thin->empty();
  return 0x1p-38 * (has_thin ? std::max<double>(most, largest(scene.thin->bounds)) : most);
}

void find_nearest(const Executor& executor, const NearestScene& scene, const PointSource& points,
                  std::uint32_t k, const std::function<void(const NearestTile&)>& take) {
  const double slack = slack_of(scene);
  for_each_tile<NearestRoom>(
      executor, points, scene.worlds, kMostTileFound / k,
      [&](const TilePoints& tile, NearestRoom* room) {
        room->found.resize(tile.points.size * k);
        find_nearest_in_order({&scene, static_cast<std::uint32_t>(tile.begin), tile.points.data,
                               tile.order.data(), tile.count(), k, slack, room->found.data(),
                               &room->stack, &executor});
        take({tile.begin, tile.points, tile.order.data(), room->found});
      });
}

}  // namespace raysheaf
