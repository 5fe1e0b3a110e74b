// Builds a fine object tree while the former tree is traced, a slice at each query, so that no
// query waits for a whole build.
//
//   former tree ─► boxes of its triangles ─► cuts by surface ─► parts ─► leaves, nodes, corners
//                  advance    advance    advance   ...   advance         finish
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "base/buffer.h"
#include "object_tree/area_tree.h"
#include "object_tree/object_tree.h"

namespace raysheaf {

/// Triangles may move, and the tree may be refitted, between the slices. If the tree is built
/// again, or its triangles are replaced, `abandon` it.
class FineBuild {
 public:
  /// `tree` must not be empty. O(1).
  void begin(const ObjectTree& tree);
  /// Frees everything.
  void abandon() { *this = {}; }

  [[nodiscard]] bool has_begun() const { return area_ != nullptr; }
  [[nodiscard]] bool is_complete() const { return builder_.has_value() && builder_->is_complete(); }

  /// Continues for about `ns` nanoseconds of one core, or not at all if a step takes longer;
  /// returns what the steps took, by their work and not by a clock: the same with any number of
  /// threads.
  double advance(const Executor& executor, const ObjectTree& tree, double ns);

  /// Replaces `tree`, if `is_complete()`, and refits it to the source; returns what
  /// `refit_object_tree` does. O(M), about one and a half refits.
  [[nodiscard]] bool finish(const Executor& executor, const TriangleSource& source,
                            ObjectTree* tree);

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  /// Appends the boxes of triangles below the next nodes; returns how many.
  std::uint32_t gather(const Executor& executor, const ObjectTree& tree, std::uint64_t visits);

  Buffer<AreaItem> items_;       ///< boxes of the triangles, with their numbers
  std::uint32_t gathered_ = 0;   ///< of the items
  std::uint32_t next_node_ = 0;  ///< of the tree
  std::unique_ptr<AreaTree> area_;
  std::optional<AreaTreeBuilder> builder_;  ///< over the items, if all are gathered
};

}  // namespace raysheaf
