// Sorts triangles along a Morton curve through the cells of their centres.
#pragma once

#include "object_tree/object_tree.h"
#include "object_tree/tree_scratch.h"

namespace raysheaf {

/// Fills `tree->scratch.sorted`, not yet sorted, with keys above numbers or strips, and
/// `tree->scratch.tasks`: runs of it that are in the order of the curve, each unsorted internally.
/// Lists the triangles without area, ascending, unless they are kept. The numbers of joined leaves
/// are places in `tree->scratch.source_leaves`, and their quads are complete. O(count) work;
/// returns the bits of a number or strip.
std::uint32_t bucket_along_curve(const Executor& executor, const TriangleSource& source,
                                 Joining joining, const TreeOptions& options, ObjectTree* tree);

/// Sorts the items of a task by key, then number. `spare` has the same length. O(count).
void sort_run(std::uint64_t* items, std::uint64_t* spare, std::uint32_t count,
              std::uint32_t id_bits);

}  // namespace raysheaf
