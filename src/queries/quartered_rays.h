// Incoherent rays that traverse the tree together: up to two million of a batch, processed tile by
// tile, with each tile sorted by quarters.
//
//   caller   0 1 2 3 | 4 5 6 7        rays of quarters a and b: a b b a | b a a b
//   here     0 3 1 2 | 5 6 4 7        quarter a is 0 1 | 4 5 of these, quarter b is 2 3 | 6 7
//
// A quarter's rays are read, and their hits written, in runs of hundreds. In the caller's order
// they would be at least a cache line apart, and every line would be fetched once for each quarter.
// Hits are restored to the caller's order within a tile, which stays in the caches. Four million
// random rays take 1.2 to 1.5 times as long without these copies.
#pragma once

#include "base/spares.h"
#include "methods/dual/dual.h"
#include "methods/dual/ray_order.h"
#include "queries/ray_tiles.h"
#include "rays/ray_source.h"

namespace raysheaf {

/// Belongs to one engine. For one query at a time.
class QuarteredRays {
 public:
  /// More rays would not be more coherent in the tree, but take more memory: 54 bytes per ray.
  static constexpr std::size_t kMostRays = std::size_t{1} << 21;

  /// Takes rays [begin, end) of the source, at most kMostRays. O(rays).
  void take(const Executor& executor, const RaySource& rays, std::size_t begin, std::size_t end);

  [[nodiscard]] View<const Ray> rays() const { return {rays_.data(), rays_.size()}; }
  /// The order of `rays()` by quarter.
  [[nodiscard]] const RayOrder& order() const { return order_; }

  /// Room for the hits of `rays()`.
  [[nodiscard]] View<IndexedHit> hits();
  [[nodiscard]] View<std::uint8_t> occluded();
  /// Passes the hits on in the caller's order.
  void hand_over_hits(const Executor& executor, const HitSink& sink);
  void hand_over_occluded(const Executor& executor, View<std::uint8_t> occluded) const;

  [[nodiscard]] std::size_t bytes() const;

 private:
  static constexpr std::size_t kTile = 16384;  ///< rays: half a MiB

  using Starts = std::array<std::uint32_t, kQuarters + 1>;

  /// Calls `body(first ray, end, tile's number)` for all tiles.
  template <class Body>
  void for_each_tile(const Executor& executor, const Body& body) const;

  std::size_t first_ = 0;  ///< the caller's number of the first ray
  Buffer<Ray> rays_;
  Buffer<std::uint16_t> numbers_;  ///< of `rays_`: the caller's number within the tile
  std::vector<Starts> starts_;     ///< of the quarters in each tile
  RayOrder order_;
  Buffer<IndexedHit> hits_;
  Buffer<std::uint8_t> occluded_;
  Spares<RayTile> spares_;
};

}  // namespace raysheaf
