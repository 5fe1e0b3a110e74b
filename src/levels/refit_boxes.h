// A tree whose leaves have moved.
#pragma once

#include "base/view.h"
#include "exec/executor.h"
#include "object_tree/bvh_node.h"
#include "object_tree/tree_emission.h"
#include "object_tree/tree_kernels.h"

namespace raysheaf {

/// Gives leaves the boxes of `box_of(node, child)`, and nodes those of what is below them. Returns
/// the sum of `cost_below`. Children follow their parents in `nodes`.
template <class BoxOf>
double refit_boxes(const Executor& executor, View<BvhNode> nodes, const BoxOf& box_of) {
  executor.for_each(nodes.size, kWorkGrain / kBvhWidth, [&](std::size_t n) {
    BvhNode& node = nodes[n];
    for (std::uint32_t c = 0; c < node.children; ++c)
      if (node.is_leaf(c)) node.set_box(c, box_of(node, c));
  });
  double cost = 0;
  for (std::size_t n = nodes.size; n-- > 0;) {
    BvhNode& node = nodes[n];
    for (std::uint32_t c = 0; c < node.children; ++c) {
      if (node.is_leaf(c)) continue;
      Box below;
      node_box(nodes[node.first[c]], &below);
      node.set_box(c, below);
    }
    cost += cost_below(node);
  }
  return cost;
}

}  // namespace raysheaf
