// Builds a fine object tree while the former tree is traced, a slice at each query, so that no
// query waits for a whole build.
//
//   former tree ─► boxes of its triangles ─► cuts by surface ─► parts ─► leaves ─► nodes ─► corners
//                  advance    advance    advance   ...   advance   advance   advance   advance
#pragma once

#include <cstddef>
#include <memory>

#include "object_tree/object_tree.h"

namespace raysheaf {

/// Triangles may move, and the tree may be refitted, between the slices. If the tree is built
/// again, or its triangles are replaced, `abandon` it.
class FineBuild {
 public:
  FineBuild();
  ~FineBuild();
  FineBuild(FineBuild&&) noexcept;
  FineBuild& operator=(FineBuild&&) noexcept;

  /// `tree` must not be empty. O(1).
  void begin(const ObjectTree& tree);
  /// Frees everything.
  void abandon() { *this = {}; }

  [[nodiscard]] bool has_begun() const { return state_ != nullptr; }
  [[nodiscard]] bool is_complete() const;

  /// Triangles have moved since it began: `finish` refits, and no slice reads corners.
  void triangles_moved();

  /// Continues for about `ns` nanoseconds of one core, or not at all if a step takes longer;
  /// returns what the steps took, by their work and not by a clock: the same with any number of
  /// threads. `source`: where the triangles of `tree` are, unless they have moved.
  double advance(const Executor& executor, const TriangleSource& source, const ObjectTree& tree,
                 double ns);

  /// Replaces `tree`, if `is_complete()`. Where triangles have moved, refits it to the source and
  /// returns what `refit_object_tree` does: O(M). Otherwise true: O(1).
  [[nodiscard]] bool finish(const Executor& executor, const TriangleSource& source,
                            ObjectTree* tree);

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace raysheaf
