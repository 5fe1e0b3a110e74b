// The two levels of instances, kept from change to change: what `trace_levels.h` needs.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "levels/forest.h"
#include "levels/level_scene.h"
#include "levels/moving_mesh.h"
#include "scene/placed_runs.h"

namespace raysheaf {

class Levels {
 public:
  /// The triangles of meshes that `update` would have to build trees for. `of`: empty, or not zero
  /// for the instances that it would get. O(instances).
  [[nodiscard]] std::uint64_t missing_triangles(View<const PlacedInstance> instances,
                                                View<const std::uint8_t> of = {}) const;
  /// Brings the levels to where these instances stand, whose vertices may wait: `members` by their
  /// numbers, ascending, or all. Trees of other meshes are kept. `marks`: one for each of these.
  /// Returns the `inst_id` of an instance that has no boxes in the world (`Placing::has_boxes`),
  /// and the levels must not be used, or kInvalidId. O(instances log instances), and what missing
  /// trees take; the arrays of the meshes are read only for those.
  [[nodiscard]] std::uint32_t update(const Executor& executor, const PlacedRuns& placed,
                                     View<const LevelMark> marks,
                                     View<const std::uint32_t> members = {});
  /// The `inst_id` of an instance that rays cannot enter (`Placing::may_enter`), or kInvalidId;
  /// points enter all.
  [[nodiscard]] std::uint32_t refuses_rays() const { return refuses_rays_; }
  /// Brings the tree over all instances to where they stand since the last update, and the trees of
  /// worlds. `in_time`: those of rays with times.
  void update_top(const Executor& executor, bool in_time = false);
  void update_forest(const Executor& executor, bool in_time = false);
  /// Valid until the next update, with those trees that stand where the instances do. `times`:
  /// null, or those of rays.
  [[nodiscard]] LevelScene scene(const float* times = nullptr) const;
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  /// The boxes of the instances, and the trees over them.
  struct Above {
    std::vector<Box> boxes;
    TopTree top;
    std::size_t top_size = 0;
    Forest forest;
    bool boxes_are_behind = true, top_is_behind = true, forest_is_behind = true;
  };
  struct MeshTree {
    std::uint64_t shape = 0;
    ObjectTree tree;
    std::optional<MovingMesh> moving;
  };
  void forget_old_trees(View<const PlacedInstance> scene);
  [[nodiscard]] const MeshTree& mesh_of(const Executor& executor, const PlacedInstance& instance);
  [[nodiscard]] Above& above(const Executor& executor, bool in_time);

  std::map<std::uint32_t, MeshTree> trees_;  ///< by geom_id
  std::vector<LevelInstance> instances_;
  std::vector<WorldId> worlds_;              ///< of them
  std::vector<View<const Affine>> motions_;  ///< of them; empty if neither they nor meshes move
  Above above_[2];                           ///< at time 0, and at all times
  std::uint32_t refuses_rays_ = 0xffffffff;
};

}  // namespace raysheaf
