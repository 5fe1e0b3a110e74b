// Goes down the tree of a device, the nearer child first: the work of one thread.
#pragma once

#include "object_tree/linear_tree_body.h"

namespace raysheaf {

/// A node or leaf that waits, and where its box begins.
struct alignas(8) LinearStop {
  float near;
  std::uint32_t at;
};

/// Calls `leaf(place)` with the first place of each leaf whose box is entered: `enter(box, &near)`
/// returns whether, and where; of two children, that with the lesser `near` comes first. The other
/// waits, and is visited if `waits(near)` still holds by then.
template <class Enter, class Waits, class Leaf>
RAYSHEAF_HD void walk_linear_tree(const LinearTreeView& tree, const Enter& enter,
                                  const Waits& waits, const Leaf& leaf) {
  if (tree.count == 0) return;
  LinearStop waiting[kLinearDepth];
  std::uint32_t top = 0, next = tree.count <= kLinearLeaf ? kLeafBit : 0;
  for (;;) {
    bool on = false;
    if ((next & kLeafBit) != 0) {
      leaf(next & ~kLeafBit);
    } else {
      const LinearNode node = tree.nodes[next];  // copied as a whole, in words of 16 bytes
      float near_0, near_1;
      const bool in_0 = enter(node.box[0], &near_0);
      const bool in_1 = enter(node.box[1], &near_1);
      on = in_0 || in_1;
      const bool first = in_0 && !(in_1 && near_1 < near_0);
      next = first ? node.child[0] : node.child[1];
      if (in_0 && in_1)
        waiting[top++] =
            first ? LinearStop{near_1, node.child[1]} : LinearStop{near_0, node.child[0]};
    }
    while (!on) {
      if (top == 0) return;
      const LinearStop stop = waiting[--top];
      next = stop.at;
      on = waits(stop.near);
    }
  }
}

}  // namespace raysheaf
