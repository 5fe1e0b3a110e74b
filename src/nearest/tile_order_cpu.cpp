#include "nearest/tile_order.h"

#include <algorithm>

#include "object_tree/curve_order.h"
#include "rays/curve_body.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kAxisBits = 15;
static_assert(kTileBits + 3 * kAxisBits <= 64);

/// Sorts points of one world, whose numbers are in the low bits of `order`.
void sort_along_curve(const QueryPoint* points, std::uint32_t count, std::uint64_t* order,
                      std::uint64_t* spare) {
  const auto at = [&](std::uint32_t i) { return points[order[i] & (kMostTilePoints - 1)].at; };
  Point low = at(0), high = low;
  for (std::uint32_t i = 1; i < count; ++i) {
    const Point p = at(i);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Point size = high - low;
  const double longest = std::max({size.x, size.y, size.z});
  constexpr double kCells = (1u << kAxisBits) - 1;
  const double scale = longest > 0 ? kCells / longest : 0;
  const auto cell = [&](double x, double from) {
    const double place = (x - from) * scale;  // points that are not validated may be NaN
    return place > 0 ? static_cast<std::uint32_t>(std::min(place, kCells)) : 0;
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    const Point p = at(i);
    const Cell<3> here{{cell(p.z, low.z), cell(p.y, low.y), cell(p.x, low.x)}};
    order[i] = morton_place(here) << kTileBits | (order[i] & (kMostTilePoints - 1));
  }
  sort_run(order, spare, count, kTileBits);
}

}  // namespace

void order_tile(const QueryPoint* points, const ItemWorlds& worlds, std::uint32_t count,
                std::uint64_t* order, std::uint64_t* spare) {
  for (std::uint32_t i = 0; i < count; ++i) order[i] = std::uint64_t{worlds[i]} << kTileBits | i;
  if (worlds.are_given()) sort_run(order, spare, count, kTileBits);
  for (std::uint32_t begin = 0, end = 0; begin < count; begin = end) {
    const std::uint64_t world = order[begin] >> kTileBits;
    while (end < count && order[end] >> kTileBits == world) ++end;
    sort_along_curve(points, end - begin, order + begin, spare);
  }
}

}  // namespace raysheaf
