#include "nearest/tile_order.h"

#include <algorithm>

#include "object_tree/curve_order.h"
#include "rays/curve_body.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kAxisBits = 15;
static_assert(kTileBits + 3 * kAxisBits <= 64);

}  // namespace

void order_tile(const QueryPoint* points, std::uint32_t count, std::uint64_t* order,
                std::uint64_t* spare) {
  if (count == 0) return;
  Point low = points[0].at, high = low;
  for (std::uint32_t i = 1; i < count; ++i) {
    const Point& p = points[i].at;
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
    const Point& p = points[i].at;
    const Cell<3> at{{cell(p.z, low.z), cell(p.y, low.y), cell(p.x, low.x)}};
    order[i] = morton_place(at) << kTileBits | i;
  }
  sort_run(order, spare, count, kTileBits);
}

}  // namespace raysheaf
