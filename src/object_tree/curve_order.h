// Triangles along a Morton curve through the cells of their centres.
#pragma once

#include "object_tree/object_tree.h"
#include "object_tree/tree_scratch.h"

namespace raysheaf {

/// Fills `scratch->sorted`, not yet in order, with keys above numbers, and `scratch->tasks`: runs
/// of it that follow each other along the curve, each in no order in itself. Lists the triangles
/// without area, ascending. Returns the number of bits that numbers take. Work O(count).
std::uint32_t bucket_along_curve(const Executor& executor, const TriangleSource& source,
                                 TreeScratch* scratch, std::vector<std::uint32_t>* left_out);

/// Sorts what a task has, by key, then number. `spare` is as long. O(count).
void sort_run(std::uint64_t* items, std::uint64_t* spare, std::uint32_t count,
              std::uint32_t id_bits);

}  // namespace raysheaf
