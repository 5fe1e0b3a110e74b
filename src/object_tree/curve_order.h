// Sorts triangles along a Morton curve through the cells of their centres.
#pragma once

#include "object_tree/object_tree.h"
#include "object_tree/tree_scratch.h"

namespace raysheaf {

/// The items of a sorted run.
struct CurveItems {
  std::uint32_t id_bits = 0;  ///< of the number or strip below the key
  bool are_strips = false;    ///< of consecutive triangles (`join_triangles`), not single ones
};

/// Fills `scratch->sorted`, not yet sorted, with keys above numbers or strips, and
/// `scratch->tasks`: runs of it that are in the order of the curve, each unsorted internally. Lists
/// the triangles without area, ascending. Joins triangles if `joins_well`. O(count) work.
CurveItems bucket_along_curve(const Executor& executor, const TriangleSource& source,
                              TreeScratch* scratch, std::vector<std::uint32_t>* left_out);

/// Sorts the items of a task by key, then number. `spare` has the same length. O(count).
void sort_run(std::uint64_t* items, std::uint64_t* spare, std::uint32_t count,
              std::uint32_t id_bits);

}  // namespace raysheaf
