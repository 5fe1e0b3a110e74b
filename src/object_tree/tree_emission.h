// Converts a tree over clusters of leaves to the nodes of the object tree.
#pragma once

#include "object_tree/area_tree.h"
#include "object_tree/object_tree.h"

namespace raysheaf {

/// Fills `tree->nodes`, its regions, bounds and cost. A cluster has the leaves [ref, ref + weight),
/// 1 to 8; a leaf's `ref` is its first quad, and its weight its number of triangles. The
/// leaves of a cluster become children of the node above if it has room, otherwise of a node of
/// their own; this choice is stored in the marks of `upper`. O(clusters + leaves).
void emit_nodes(const Executor& executor, AreaTree& upper, View<const AreaItem> clusters,
                View<const AreaItem> leaves, ObjectTree* tree);

/// The same for one region after the other (`ObjectTree::region_starts`). The arrays and the trees
/// must outlive it.
class NodeEmission {
 public:
  NodeEmission(AreaTree& upper, View<const AreaItem> clusters, View<const AreaItem> leaves,
               ObjectTree* tree);
  [[nodiscard]] std::size_t region_count() const { return costs_.size(); }

  /// Counts the nodes of a region, and then, when those of all are counted, gives each its place
  /// and writes them. Different regions may be counted, or written, by several threads.
  void count(std::size_t region);
  void place();
  void write(std::size_t region);
  /// Computes the bounds and the cost of the tree.
  void finish();

 private:
  [[nodiscard]] std::vector<AreaNode>& nodes_of(std::size_t region) const;

  AreaTree& upper_;
  View<const AreaItem> clusters_, leaves_;
  ObjectTree& tree_;
  std::vector<double> costs_;  ///< of each region
};

/// Reads the corners of the quads [begin, end) of `tree`, whose triangle numbers are known, and
/// stores the boxes of quads in `tree.scratch.leaves`. Triangles without area become points.
void refill_quads(const TriangleSource& source, std::size_t begin, std::size_t end,
                  const ObjectTree& tree);

/// The cost of a node's children: half the surface of each, times 1 for a node or its quads for a
/// leaf.
double cost_below(const BvhNode& node);

/// Half the surface, in binary64, so that the largest coordinates do not overflow.
double half_area(const Box& box);

/// Computes bounds and cost of a tree whose nodes have their boxes; `below` is the sum of
/// `cost_below`.
void finish_tree(double below, ObjectTree* tree);

}  // namespace raysheaf
