// The rays of a batch in order, and the tree of shafts over them, for culling blocks.
//
//   level 3   [-----------------------------------]        a block's box traverses the tree; at the
//   level 2   [--16--][--16--][--16--][--16--] ...         leaves it is tested with the rays
//   level 1   [16][16][16] ...                             themselves
//   rays      ...........................
//
// Rays are shortened to their hits, so the tree can be rebuilt more tightly: `refresh`.
#pragma once

#include <vector>

#include "exec/executor.h"
#include "out_of_core/block_body.h"

namespace raysheaf {

class RayTree {
 public:
  /// `scene` must contain all triangles. Rays must have been validated. O(rays log rays).
  RayTree(const Executor& executor, View<const Ray> rays, const Box& scene);

  [[nodiscard]] std::size_t size() const { return rays_.size(); }
  /// The ray at a place of the order, with its current end; and the caller's number of it.
  [[nodiscard]] const Ray& ray(std::uint32_t place) const { return rays_[place]; }
  [[nodiscard]] std::uint32_t number(std::uint32_t place) const { return numbers_[place]; }

  /// Whether any ray may intersect the box. A leaf's shaft may intersect it even if none of its
  /// rays does.
  [[nodiscard]] bool meets(const Box& box) const;
  /// The squared distance from the box to the nearest box of origins of the leaves that intersect
  /// it; negative if none does.
  [[nodiscard]] float squared_distance(const Box& box) const;
  /// The places, ascending, of the rays that may intersect the box.
  void find(const Box& box, std::vector<std::uint32_t>* places) const;

  /// Shortens the ray at `place` to `t`, which must not exceed its current end.
  void shorten(std::uint32_t place, float t) { rays_[place].t_max = t; }
  /// The ray at `place` is done: it loses its number, and is not found any more.
  void finish(std::uint32_t place) {
    numbers_[place] = kInvalidId;
    rays_[place].t_max = -1;
  }
  /// Rebuilds the tree for the current rays. Places change if rays are done. O(rays).
  void refresh(const Executor& executor);

 private:
  void build(const Executor& executor);
  /// Calls `leaf(number, first, end)` for the leaves that intersect the box, until it returns
  /// false.
  template <class Leaf>
  void walk(const Box& box, const Leaf& leaf) const;

  Box scene_;
  std::vector<Ray> rays_;
  std::vector<std::uint32_t> numbers_;
  std::vector<std::vector<BeamTest>> levels_;  ///< [0]: the leaves
};

}  // namespace raysheaf
