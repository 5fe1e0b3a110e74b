// What is another in a scene description since it was last shown: what lets a renderer keep all
// that it has made of the rest.
#pragma once

#include <cstdint>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf {

/// Cameras and lights are not named: they are read anew for each picture. Lists ascend, without
/// repetition.
struct SceneChanges {
  bool everything = false;  ///< anything may have changed, and nothing below counts
  /// Instances whose `to_world` is another one.
  std::vector<std::uint32_t> moved;
  /// Meshes whose positions and normals are others, as many as before; all else stays.
  std::vector<std::uint32_t> deformed;
  /// Meshes and instances from these numbers on are other ones, and there may be another number of
  /// them. `kInvalidId`: none.
  std::uint32_t other_meshes_from = kInvalidId, other_instances_from = kInvalidId;

  [[nodiscard]] bool empty() const;
  /// What has changed where first `*this` and then `later` happened.
  void add(const SceneChanges& later);
};

/// `validate` for what has changed alone; cameras and lights too.
void validate_changes(const SceneDescription& scene, const SceneChanges& changes);

/// `validate` for a camera that is in no scene.
void validate_camera(const Camera& camera);

}  // namespace raysheaf
