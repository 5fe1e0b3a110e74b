// Stage 4: levels of ray bounds over ordered rays, an implicit n-ary tree.
//
//   level 2   [----------------------64----------------------] ...
//   level 1   [--8--][--8--][--8--][--8--][--8--][--8--] ...        node i of level l has the
//   rays      ........................................ ...          children i*b .. i*b + b - 1
//                                                                   of level l - 1
//
// Built bottom-up: leaves from their rays, upper levels from the bounds below (Roger, Assarsson,
// Holzschuch 2007; Reis, Costa, Pereira 2017, section 3.4). O(rays) work, `levels` steps.
#pragma once

#include <cstdint>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "paper/bounds/bounds.h"

namespace raysheaf {

/// `Bound`: one of those in paper/bounds/bounds.h.
template <class Bound>
struct RayHierarchy {
  std::uint32_t branching = 8;
  std::uint32_t ray_count = 0;
  std::vector<std::vector<Bound>> levels;  ///< [0] is level 1, the leaves; the last one is the top

  [[nodiscard]] std::uint32_t top() const { return static_cast<std::uint32_t>(levels.size()); }
  /// The nodes of a level, counted from 1.
  [[nodiscard]] const std::vector<Bound>& level(std::uint32_t l) const { return levels[l - 1]; }
};

/// `levels` at least 1, `branching` at least 2; without rays the levels are empty. `scene` must
/// contain everything that the rays may hit. Defined for the bounds of paper/bounds/bounds.h.
template <class Bound>
[[nodiscard]] RayHierarchy<Bound> build_hierarchy(const Executor& executor, View<const Ray> rays,
                                                  const Box& scene, std::uint32_t branching,
                                                  std::uint32_t levels);

}  // namespace raysheaf
