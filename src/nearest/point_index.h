// Data that queries of points need in addition to the object tree, kept from query to query.
#pragma once

#include "nearest/inside.h"

namespace raysheaf {

/// Not for use by two threads at once. `version` names the triangles as they are: where it is
/// another one, the data is computed again.
class PointIndex {
 public:
  [[nodiscard]] NearestScene scene(const Executor& executor, const TriangleSource& source,
                                   const ObjectTree& tree, std::uint64_t version) {
    if (thin_version_ != version) {
      thin_version_ = 0;  // until it is whole: memory may run out
      build_thin_tree(executor, source, tree, &thin_);
      thin_version_ = version;
    }
    return {&tree, &thin_};
  }
  [[nodiscard]] Closedness closedness(const Executor& executor, const TriangleSource& source,
                                      std::uint64_t version) {
    if (closedness_version_ != version) {
      closedness_ = closedness_of(executor, source);
      closedness_version_ = version;
    }
    return closedness_;
  }
  [[nodiscard]] std::size_t memory_bytes() const { return thin_.memory_bytes(); }

 private:
  ObjectTree thin_;
  Closedness closedness_;
  std::uint64_t thin_version_ = 0, closedness_version_ = 0;  ///< 0: of none
};

}  // namespace raysheaf
