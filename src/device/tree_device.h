// The object tree of an engine on a device, and its age. For sources that include a device.
#pragma once

#include "object_tree/linear_tree.h"
#include "queries/plan.h"

namespace raysheaf {

/// The work on the tree, and why it was done.
[[nodiscard]] inline const char* sentence_of(TreeWork work) {
  if (work == TreeWork::kRebuild)
    return "object tree: built along a curve, because the triangles are new or have moved far";
  return work == TreeWork::kRefit ? "object tree: refitted, because the same triangles have moved"
                                  : "object tree: kept, because no triangle has moved";
}

/// The same sentence about a tree over instances.
[[nodiscard]] inline const char* sentence_of_top(TreeWork work) {
  if (work == TreeWork::kRebuild)
    return "tree over instances: built along a curve, because they are others or have moved far";
  return work == TreeWork::kRefit ? "tree over instances: refitted, because they have moved"
                                  : "tree over instances: kept, because none has moved";
}

template <class Device>
class DeviceTree {
 public:
  explicit DeviceTree(Device& device) : device_(device), tree_(device.allocator()) {}

  /// The triangles change. `same_triangles`: they only move.
  void forget(bool same_triangles) {
    there_ = there_ && same_triangles;
    moved_ = true;
  }

  /// Updates the tree to the triangles' positions; returns how. The tree is refitted until its
  /// expected cost has grown too much, and then rebuilt, even if nothing has moved since.
  TreeWork prepare(const TriangleList& list) {
    if (!there_ || spoilt_ || list.count() != tree_.view().count) return build(list);
    if (!moved_) return TreeWork::kKeep;
    learn_cost();  // if the query that built the tree did not finish
    there_ = false;
    tree_.refit(device_, list);
    there_ = has_new_cost_ = true;
    moved_ = false;
    return TreeWork::kRefit;
  }

  /// Reads the tree's cost after its work is done. Waits if the tree has changed, else does
  /// nothing.
  void learn_cost() {
    if (!has_new_cost_) return;
    const double cost = tree_.cost(device_);
    if (cost_when_built_ < 0) cost_when_built_ = cost;
    spoilt_ = cost > double{kSpoilt} * cost_when_built_;
    has_new_cost_ = false;
  }

  [[nodiscard]] LinearTreeView view() const { return tree_.view(); }
  [[nodiscard]] const SharedBox* scene() const { return tree_.scene(); }
  [[nodiscard]] std::size_t memory_bytes() const { return tree_.memory_bytes(); }

 private:
  TreeWork build(const TriangleList& list) {
    there_ = spoilt_ = false;
    cost_when_built_ = -1;
    tree_.build(device_, list);
    there_ = has_new_cost_ = true;
    moved_ = false;
    return TreeWork::kRebuild;
  }

  Device& device_;
  LinearTree tree_;
  bool there_ = false;           ///< a tree of these triangles, at these or at former positions
  bool moved_ = false;           ///< the tree is for former positions
  bool has_new_cost_ = false;    ///< the cost was not read yet
  bool spoilt_ = false;          ///< refits have made the tree much worse than when it was built
  double cost_when_built_ = -1;  ///< negative: unknown
};

}  // namespace raysheaf
