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

/// The cost of a node's children: half the surface of each, times 1 for a node or its quads for a
/// leaf.
double cost_below(const BvhNode& node);

/// Half the surface, in binary64, so that the largest coordinates do not overflow.
double half_area(const Box& box);

/// Computes bounds and cost of a tree whose nodes have their boxes; `below` is the sum of
/// `cost_below`.
void finish_tree(double below, ObjectTree* tree);

}  // namespace raysheaf
