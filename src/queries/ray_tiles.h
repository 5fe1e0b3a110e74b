// Traces batches of coherent rays through the tree tile by tile. A thread takes a few thousand
// rays, packs and orders them, traces them and passes on their hits, all within its caches. Running
// each stage for the whole batch would fetch every ray from memory once for each stage: four
// million shadow rays take 1.2 to 1.35 times as long.
#pragma once

#include <functional>

#include "base/spares.h"
#include "methods/dual/dual.h"
#include "methods/dual/ray_order.h"
#include "rays/ray_source.h"

namespace raysheaf {

/// Receives results: hits[i] is that of ray `begin` + i. Called by several threads.
using HitSink = std::function<void(std::size_t begin, View<const IndexedHit> hits)>;

/// Milliseconds of the loop over all tiles, divided in proportion to the threads' times.
struct TileTimes {
  double take_ms = 0, order_ms = 0, trace_ms = 0;
};

/// Belongs to one engine. For one query at a time.
class RayTiles {
 public:
  /// The number of rays of each tile of a batch except the last. `row` as in `order_rays`.
  [[nodiscard]] static std::size_t tile_size(std::size_t rays, std::size_t row);

  /// `scene` as in `trace_closest`. Adds to `counts`, which are the same with any number of
  /// threads.
  TileTimes closest_hit(const Executor& executor, const RaySource& rays, std::size_t row,
                        const DualScene& scene, const HitSink& sink, DualCounts* counts);
  TileTimes any_hit(const Executor& executor, const RaySource& rays, std::size_t row,
                    const DualScene& scene, View<std::uint8_t> occluded, DualCounts* counts);

  [[nodiscard]] std::size_t bytes() const { return spares_.bytes(); }

 private:
  struct Tile {
    Buffer<Ray> rays;
    Buffer<IndexedHit> hits;
    RayOrder order;

    [[nodiscard]] std::size_t bytes() const {
      return rays.capacity_bytes() + hits.capacity_bytes() + order.bytes();
    }
  };

  /// Calls `trace(tile, begin, rays, serial, counts)` for all tiles.
  template <class Trace>
  TileTimes run(const Executor& executor, const RaySource& rays, std::size_t row,
                DualCounts* counts, const Trace& trace);

  Spares<Tile> spares_;
};

}  // namespace raysheaf
