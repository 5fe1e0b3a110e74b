// Sorts triangles along a Morton curve through the cells of their centres.
#pragma once

#include "object_tree/object_tree.h"
#include "object_tree/tree_scratch.h"

namespace raysheaf {

/// The items that a curve sorts.
struct CurveItems {
  Joining joining = Joining::kNone;
  std::uint32_t id_bits = 0;  ///< of the number or strip below the key
};

/// Fills `tree->scratch.sorted`, not yet sorted, with keys above numbers or strips, and
/// `tree->scratch.tasks`: runs of it that are in the order of the curve, each unsorted internally.
/// Lists the triangles without area, ascending, unless they are kept. The numbers of joined leaves
/// are places in `tree->scratch.source_leaves`, and their quads are complete. O(count) work.
[[nodiscard]] CurveItems bucket_along_curve(const Executor& executor, const TriangleSource& source,
                                            Joining joining, const TreeOptions& options,
                                            ObjectTree* tree);

/// Gives items that share one cell, because the scene is so much larger, the keys of a curve
/// through the box of their own centres. Returns false if their centres are equal. The keys may
/// only be compared with each other. O(count).
[[nodiscard]] bool refine_keys(const Executor& executor, const TriangleSource& source,
                               const CurveItems& curve, const TreeScratch& scratch,
                               std::uint64_t* items, std::uint32_t count);

/// Sorts the items of a task by key, then number. `spare` has the same length. O(count).
void sort_run(std::uint64_t* items, std::uint64_t* spare, std::uint32_t count,
              std::uint32_t id_bits);

}  // namespace raysheaf
