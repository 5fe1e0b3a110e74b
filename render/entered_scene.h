// The scene of a renderer whose rays enter instances where they stand, so that an image places no
// triangle (levels/levels.h).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "exec/executor.h"
#include "levels/levels.h"
#include "queries/level_plan.h"
#include "raysheaf/scene_changes.h"
#include "scene/flat_scene.h"

namespace raysheaf {

class EnteredScene {
 public:
  /// Notes all changes, also those that an image with placed triangles follows. O(triangles of the
  /// meshes that are new).
  void note(const SceneDescription& scene, const SceneChanges& changes);

  /// Whether an image of about `rays` rays had better enter the instances of the scene than place
  /// what has changed since they were placed: `unplaced`. `is_new`: the scene has changed since the
  /// last image. Then brings the levels up to date. O(instances log instances), and what the trees
  /// of new meshes take.
  [[nodiscard]] bool enter(const Executor& executor, const SceneDescription& scene,
                           const SceneChanges& unplaced, bool is_new, std::uint64_t rays);

  /// The rest is valid after `enter` has returned true, until the next `note`.
  [[nodiscard]] const FlatScene& scene() const { return standing_; }
  [[nodiscard]] LevelScene levels() const { return levels_.scene(); }
  /// Why rays enter.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  [[nodiscard]] bool settle(const Executor& executor);

  std::vector<MeshShape> shapes_;
  std::uint64_t versions_ = 0;  ///< of shapes
  FlatScene standing_;
  bool is_listed_ = false, is_settled_ = false;  ///< since the last change
  bool has_new_shapes_ = false;                  ///< since the last image that asked
  bool may_enter_ = false;
  std::uint32_t refused_ = kInvalidId;  ///< the index of an instance that rays cannot enter
  Levels levels_;
  LevelPlan plan_;
  std::string reason_;
};

/// Whether the machine has no room for the triangles of all instances, or there are more than a
/// flat scene numbers.
[[nodiscard]] bool is_too_large_to_place(const SceneDescription& scene);

}  // namespace raysheaf
