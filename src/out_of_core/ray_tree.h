// The rays of a batch in order, and the tree of shafts over them: what blocks are culled against.
//
//   level 3   [-----------------------------------]        a block's box goes down the tree; at the
//   level 2   [--16--][--16--][--16--][--16--] ...         leaves it is tested with the rays
//   level 1   [16][16][16] ...                             themselves
//   rays      ...........................
//
// Rays end at what they have hit so far, so that the tree shrinks as hits are found: `refresh`.
#pragma once

#include <vector>

#include "exec/executor.h"
#include "methods/dual/ray_order.h"
#include "out_of_core/block_body.h"

namespace raysheaf {

class RayTree {
 public:
  /// `scene` holds all triangles. Rays have been checked. O(rays log rays).
  RayTree(const Executor& executor, View<const Ray> rays, const Box& scene);

  [[nodiscard]] std::size_t size() const { return rays_.size(); }
  /// The ray at a place of the order, with the end that it has now; and the caller's number of it.
  [[nodiscard]] const Ray& ray(std::uint32_t place) const { return rays_[place]; }
  [[nodiscard]] std::uint32_t number(std::uint32_t place) const { return numbers_[place]; }

  /// Whether any ray may meet the box. A leaf's shaft may be met where none of its rays is.
  [[nodiscard]] bool meets(const Box& box) const;
  /// From the box to the nearest box of origins of the leaves that meet it; negative where none
  /// does.
  [[nodiscard]] float squared_distance(const Box& box) const;
  /// The places, ascending, of the rays that may meet the box.
  void find(const Box& box, std::vector<std::uint32_t>* places) const;

  /// From now on the ray at `place` ends at `t`, which is no later than before.
  void shorten(std::uint32_t place, float t) { rays_[place].t_max = t; }
  /// The ray at `place` is done: it has no number any more, and is not found.
  void finish(std::uint32_t place) {
    numbers_[place] = kInvalidId;
    rays_[place].t_max = -1;
  }
  /// Makes the tree fit the rays. Places change where rays were finished. O(rays).
  void refresh(const Executor& executor);

 private:
  void build(const Executor& executor);
  /// Calls `leaf(number, first, end)` for the leaves that meet the box, until it returns false.
  template <class Leaf>
  void walk(const Box& box, const Leaf& leaf) const;

  Box scene_;
  std::vector<Ray> rays_;
  std::vector<std::uint32_t> numbers_;
  std::vector<std::vector<BeamTest>> levels_;  ///< [0]: the leaves
};

}  // namespace raysheaf
