// Traces batches of coherent rays through the tree tile by tile. A thread takes a few thousand
// rays, packs and orders them, traces them and passes on their hits, all within its caches. Running
// each stage for the whole batch would fetch every ray from memory once for each stage: four
// million shadow rays take 1.2 to 1.35 times as long.
#pragma once

#include <functional>

#include "base/spares.h"
#include "methods/dual/dual.h"
#include "methods/dual/ray_order.h"
#include "queries/query_report.h"
#include "rays/ray_source.h"

namespace raysheaf {

/// Receives results: hits[i] is that of ray `begin` + i. Called by several threads.
using HitSink = std::function<void(std::size_t begin, View<const IndexedHit> hits)>;

struct RayTile {
  std::size_t begin = 0;  ///< the batch's number of the first ray
  View<const Ray> rays;
  RayOrder order;
  Buffer<Ray> room;         ///< for `rays`, if they are not where the caller keeps them
  Buffer<IndexedHit> hits;  ///< for the user of the tile

  [[nodiscard]] std::size_t bytes() const {
    return room.capacity_bytes() + hits.capacity_bytes() + order.bytes();
  }
};

/// The number of rays of each tile of a batch except the last. `row` as in `order_rays`.
[[nodiscard]] std::size_t ray_tile_size(std::size_t rays, std::size_t row);

/// Takes and orders the rays of each tile and calls `trace`, which adds to the counts, from several
/// threads. Adds to the report, if there is one: counts, which are the same with any number of
/// threads, and times, those of the loop divided in proportion to the threads' times.
void for_each_ray_tile(const Executor& executor, const RaySource& rays, std::size_t row,
                       Spares<RayTile>* spares, QueryReport* report,
                       const std::function<void(RayTile&, DualCounts*)>& trace);

}  // namespace raysheaf
