// Rays that share an origin: shadow rays of a point light, primary rays of a camera, rays of a
// scanner.
//
// Seen from the origin, the rays are points on the six faces of a cube, and a triangle is a
// triangle on a face: its three edges are homogeneous edge functions, without division or clipping
// (DESIGN, 5.5 of the notes on algorithms; Aila & Laine 2004, "Alias-Free Shadow Maps", and Johnson
// et al. 2005, "The Irregular Z-Buffer", do it on one plane). Therefore no object tree is needed:
// the rays are sorted along a curve on the faces, and the triangles stream down the tree of cells
// over them.
//
//      face                    cells: runs of the sorted rays, their rectangle, their farthest end
//    +---------------+
//    | . .:. |   .   |
//    |---+---|  . .  |         a triangle continues into the cells that it overlaps and that
//    |. .| . |  .    |         reach beyond its nearest corner
//    +---+---+-------+
//
// The rays' coordinates on a face are the shears of the ray-triangle test
// (intersect/triangle_body.h), so that test costs little more here than a bound would.
#pragma once

#include <cstdint>
#include <memory>

#include "base/view.h"
#include "exec/executor.h"
#include "intersect/intersect_list.h"
#include "scene/triangle_source.h"

namespace raysheaf {

/// Counts and times of a query. Counts are the same with any number of threads and on every SIMD
/// target.
struct FanCounts {
  std::uint64_t bound_tests = 0;     ///< tests of a cell with a triangle, or with a bound of
                                     ///< triangles
  std::uint64_t triangle_tests = 0;  ///< tests of a ray with a triangle
  std::uint64_t pairs =
      0;  ///< pairs of tiles and overlapping triangles that were found; always filled
  double order_ms = 0, hierarchy_ms = 0, traverse_ms = 0;
};

/// Working memory of queries, kept for the next one: fresh pages cost as much as the sort. Not for
/// two queries at once. About 60 bytes per ray and 88 per pair of tile and triangle.
class FanMemory {
 public:
  FanMemory();
  ~FanMemory();
  FanMemory(FanMemory&&) noexcept;
  FanMemory& operator=(FanMemory&&) noexcept;

  struct Arrays;
  [[nodiscard]] Arrays& arrays() { return *arrays_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  std::unique_ptr<Arrays> arrays_;
};

struct FanOptions {
  Facing facing = Facing::kBoth;
  bool count = false;           ///< fill the counts of FanCounts; times are always measured
  FanMemory* memory = nullptr;  ///< null: the query allocates its own
  /// The query gives up if there are more pairs of tiles and triangles. By then up to four times as
  /// many may be in memory, plus those of one triangle for each block of triangles.
  std::uint64_t most_pairs = std::uint64_t{1} << 29;
};

/// Sets occluded[i] to 1 if rays[i] hits any triangle in [t_min, t_max], else 0, as brute force
/// does, bit for bit. If `ray_tests` is not empty, each ray's share of all tests is added to it.
/// O(rays + triangles + pairs of cells and triangles that overlap). Returns false without answers
/// if the rays do not start at the same point, bit for bit, or if there are too many pairs.
[[nodiscard]] bool occluded_in_fan(const Executor& executor, const TriangleSource& source,
                                   View<const Ray> rays, const FanOptions& options,
                                   View<std::uint8_t> occluded, View<float> ray_tests,
                                   FanCounts* counts);

}  // namespace raysheaf
