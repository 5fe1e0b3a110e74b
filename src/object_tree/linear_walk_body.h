// Goes down the tree of a device, the nearer child first: the work of one thread.
#pragma once

#include "object_tree/linear_tree_body.h"

namespace raysheaf {

/// A node or leaf that waits, and where its box begins.
struct alignas(8) LinearStop {
  float near;
  std::uint32_t at;
};

RAYSHEAF_HD inline std::uint32_t root_of(const LinearTreeView& tree) {
  return tree.count <= kLinearLeaf ? kLeafBit : 0;
}

/// The leaves are what is looked for.
struct OneLevel {
  static constexpr bool kTwoLevels = false;
};

/// Calls `leaf(place)` with the first place of each leaf whose box is entered: `enter(box, &near)`
/// returns whether, and where; of two children, that with the lesser `near` comes first. The other
/// waits, and is visited if `waits(near)` still holds by then; `near` is not negative then.
///
/// With `Levels::kTwoLevels` the leaves of the tree hold other trees, which are not empty:
/// `levels->descend(place, &tree)` goes down into the one at a place, or returns that there is no
/// need; `levels->ascend()` goes back up.
template <class Enter, class Waits, class Leaf, class Levels = OneLevel>
RAYSHEAF_HD void walk_linear_tree(const LinearTreeView& whole, const Enter& enter,
                                  const Waits& waits, const Leaf& leaf, Levels* levels = nullptr) {
  constexpr bool kTwo = Levels::kTwoLevels;
  // The last place that there is plus one, so that no stop is at it.
  constexpr std::uint32_t kBackUp = 0xffffffff;
  if (whole.count == 0) return;
  LinearStop waiting[kTwo ? 2 * kLinearDepth + 2 : kLinearDepth];
  std::uint32_t top = 0, next = root_of(whole);
  LinearTreeView tree = whole;
  bool above = kTwo;
  for (;;) {
    bool on = false;
    if ((next & kLeafBit) != 0) {
      const std::uint32_t place = next & ~kLeafBit;
      if constexpr (kTwo) {
        if (above) {
          if (tree.triangles[place].ends_leaf == 0) waiting[top++] = {0, next + 1};
          on = levels->descend(place, &tree);
          if (on) waiting[top++] = {0, kBackUp};
          if (on) next = root_of(tree);
          above = !on;
        } else {
          leaf(place);
        }
      } else {
        leaf(place);
      }
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
      if constexpr (kTwo) {
        if (stop.at == kBackUp) {
          tree = whole;
          above = true;
          levels->ascend();
          continue;
        }
      }
      next = stop.at;
      on = waits(stop.near);
    }
  }
}

}  // namespace raysheaf
