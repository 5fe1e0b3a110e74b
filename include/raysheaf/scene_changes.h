// The differences of a scene description since it was last shown. They let a renderer keep
// everything that it has computed for the rest.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "raysheaf/rig.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

/// Cameras and lights are not listed: they are read for every image. Lists are ascending, without
/// duplicates.
struct SceneChanges {
  bool everything = false;  ///< anything may have changed; the fields below are ignored
  /// Instances whose `to_world` has changed.
  std::vector<std::uint32_t> moved;
  /// Meshes whose positions and normals have changed, but not their number or anything else.
  std::vector<std::uint32_t> deformed;
  /// Meshes and instances from these numbers on have been replaced, and their number may differ.
  /// `kInvalidId`: none.
  std::uint32_t other_meshes_from = kInvalidId, other_instances_from = kInvalidId;

  /// Meshes of `deformed` whose vertices are not moved yet (`Animation::seek_poses`), and a
  /// function that moves them, in the scene. A renderer on a device moves them in the device's
  /// memory; any other renderer calls the function.
  std::vector<MeshPose> posed;
  std::function<void()> move_vertices;

  [[nodiscard]] bool empty() const;
  /// The union of these changes and of `later` ones.
  void add(const SceneChanges& later);
};

/// `validate` for the changed parts only, and for cameras and lights.
void validate_changes(const SceneDescription& scene, const SceneChanges& changes);

/// `validate` for a camera that is not part of a scene.
void validate_camera(const Camera& camera);

}  // namespace raysheaf
