// Rays that share an origin: a point light's shadow rays, a camera's, a scanner's.
//
// Seen from the origin they are points on the six faces of a cube, and a triangle is a triangle
// there: its three edges are homogeneous edge functions, no division and no clipping (DESIGN, 5.5
// of the notes on algorithms; Aila & Laine 2004, "Alias-Free Shadow Maps", and Johnson et al. 2005,
// "The Irregular Z-Buffer", do it on one plane). So no object tree is needed at all: the rays are
// sorted along a curve on the faces, and the triangles stream down the tree of cells over them.
//
//      face                    cells: runs of the sorted rays, their rectangle, their farthest end
//    +---------------+
//    | . .:. |   .   |
//    |---+---|  . .  |         a triangle goes on into the cells that it overlaps and that reach
//    |. .| . |  .    |         beyond its nearest corner
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
#include "object_tree/triangle_source.h"

namespace raysheaf {

/// What a query did. The same with any number of threads and on every SIMD target.
struct FanCounts {
  std::uint64_t bound_tests = 0;     ///< a cell with a triangle, or with a bound of triangles
  std::uint64_t triangle_tests = 0;  ///< a ray with a triangle
  std::uint64_t pairs =
      0;  ///< of tiles and triangles that meet, as far as was looked; always filled
  double order_ms = 0, hierarchy_ms = 0, traverse_ms = 0;
};

/// Memory that queries work in, kept from one to the next: fresh pages cost as much as the sort.
/// Not for use by two queries at once. About 60 bytes a ray and 88 a pair of tile and triangle.
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
  bool count = false;           ///< fill FanCounts' counts; times are always measured
  FanMemory* memory = nullptr;  ///< null: memory of the query's own
  /// More pairs of tiles and triangles are too many. By then up to four times as many may be there,
  /// and one triangle's of each block of triangles.
  std::uint64_t most_pairs = std::uint64_t{1} << 29;
};

/// occluded[i] = 1 where rays[i] meets any triangle in [t_min, t_max], else 0: what brute force
/// says, bit for bit. `ray_tests` may be empty; else each ray's share of all tests is added to it.
/// O(rays + triangles + pairs of cells and triangles that overlap). Returns false, with nothing
/// answered, where the rays do not start at the same point, bit for bit, and where there are too
/// many pairs.
[[nodiscard]] bool occluded_in_fan(const Executor& executor, const TriangleSource& source,
                                   View<const Ray> rays, const FanOptions& options,
                                   View<std::uint8_t> occluded, View<float> ray_tests,
                                   FanCounts* counts);

}  // namespace raysheaf
