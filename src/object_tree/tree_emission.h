// From a tree over clusters of leaves to the nodes of the object tree.
#pragma once

#include "object_tree/area_tree.h"
#include "object_tree/object_tree.h"

namespace raysheaf {

/// Fills `tree->nodes`, its regions, bounds and cost. A cluster has the leaves [ref, ref + weight),
/// 1 to 8, one quad each, numbered alike; a leaf's weight is its triangles. Leaves of a cluster
/// stand in the node above, where that has room, else in a node of their own;
/// `upper` is marked with which. O(clusters + leaves).
void emit_nodes(const Executor& executor, AreaTree& upper, View<const AreaItem> clusters,
                View<const AreaItem> leaves, ObjectTree* tree);

/// What the children of a node add to the cost: half the surface of each times 1, or its quads.
double cost_below(const BvhNode& node);

/// Half the surface, in binary64, where the largest coordinates cannot overflow it.
double half_area(const Box& box);

/// Bounds and cost of a tree whose nodes have their boxes; `below` is the sum of `cost_below`.
void finish_tree(double below, ObjectTree* tree);

}  // namespace raysheaf
