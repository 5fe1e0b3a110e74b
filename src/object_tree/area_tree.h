// Trees over boxes by the surface area heuristic: over all triangles for the fine object tree, over
// clusters of triangles for the one that is rebuilt each frame.
//
//   top            [ . . . . . . . . ]       few nodes, split one level after the other
//   parts     [. . .]   [. . . .]   [. .]    each by one task, from the top down
//   items      7 2 9 |   4 0 1 8 |   3 5     sorted into the order of the leaves
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/view.h"
#include "exec/executor.h"
#include "object_tree/bvh_node.h"
#include "raysheaf/types.h"

namespace raysheaf {

/// A box with a reference to its content.
struct alignas(32) AreaItem {
  Vec3 min;
  std::uint32_t ref = 0;  ///< the caller's number
  Vec3 max;
  std::uint32_t weight = 0;  ///< its cost for a ray that intersects the box
};
static_assert(sizeof(AreaItem) == 32);

/// The kind of a node's child.
struct AreaChild {
  enum Kind : std::uint32_t { kItems, kNode, kPart };
  Kind kind = kItems;
  /// kItems: [first, first + count) of the items; kNode: a node of the same list; kPart: the root
  /// of a part.
  std::uint32_t first = 0, count = 0;
};

struct AreaNode {
  Box box[kBvhWidth];
  AreaChild child[kBvhWidth];
  std::uint32_t children = 0;
  std::uint32_t mark = 0;  ///< set by the caller
};

/// Items [first, first + count), which are too many for one leaf, and the nodes over them: [0] is
/// the root, children follow their parents.
struct AreaPart {
  std::uint32_t first = 0, count = 0;
  Box box;
  std::vector<AreaNode> nodes;
};

struct AreaTree {
  std::vector<AreaNode> top;  ///< empty if `parts` has a single part
  std::vector<AreaPart> parts;
  std::size_t part_count = 0;  ///< number of `parts` in use

  [[nodiscard]] std::size_t memory_bytes() const;
};

struct AreaOptions {
  std::uint32_t leaf_items = 1;  ///< the most that a leaf holds
  bool three_axes = false;       ///< search cuts along all axes, not only the widest
  bool small_leaves = false;     ///< split leaves where that saves more than it costs
  /// Longer runs are cut by all threads, in blocks: by few in a step of `AreaTreeBuilder`.
  std::uint32_t long_run = 32768;
};

/// A node splits the child with the largest surface until it has eight children. Cuts are the best
/// among bins of the centres (Goldsmith & Salmon 1987; Wald 2007, "On fast Construction of
/// SAH-based Bounding Volume Hierarchies"). Reorders the items. O(n log n); the same tree with any
/// number of threads.
void build_area_tree(const Executor& executor, View<AreaItem> items, const AreaOptions& options,
                     AreaTree* tree);

/// The visits of items, some 8 ns of a core each, that a slice of a build may still make.
struct Visits {
  std::uint64_t left = 0;

  /// Takes `each` for as many of `count` pieces as there are visits left; returns for how many.
  std::size_t take(std::size_t count, std::uint64_t each) {
    const auto pieces = static_cast<std::size_t>(std::min<std::uint64_t>(count, left / each));
    left -= pieces * each;
    return pieces;
  }
};

/// The same in steps that each take a limited time.
class AreaTreeBuilder {
 public:
  /// Uses `items` and `tree` until it is complete, or destroyed. There must be items.
  AreaTreeBuilder(View<AreaItem> items, const AreaOptions& options, AreaTree* tree);
  ~AreaTreeBuilder();
  AreaTreeBuilder(AreaTreeBuilder&&) noexcept;
  AreaTreeBuilder& operator=(AreaTreeBuilder&&) noexcept;

  /// Continues with whole steps for which there are visits left. A step visits each item of a run
  /// of up to `long_run` fifteen times, or each of a part's 1024 items 55 times: with fewer visits,
  /// it may do nothing. The same tree with any number of threads and any steps. If it throws, the
  /// tree must be begun again.
  void advance(const Executor& executor, Visits* visits);
  [[nodiscard]] bool is_complete() const;
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  class Steps;
  std::unique_ptr<Steps> steps_;
};

}  // namespace raysheaf
