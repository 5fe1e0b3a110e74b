// A flat scene that follows its description, without making anew what has not changed.
#pragma once

#include <cstdint>
#include <vector>

#include "raysheaf/scene_changes.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// The ball of one mesh, as `mesh_bounds` has it.
[[nodiscard]] Sphere mesh_bound(const Mesh& mesh);

/// Brings the balls to what `changes` made of `scene`: those of meshes that keep their shape stay.
/// Returns how many were computed.
std::uint32_t update_bounds(const Executor& executor, const SceneDescription& scene,
                            const SceneChanges& changes, std::vector<Sphere>* bounds);

/// What `update_flat` made anew.
struct FlatUpdate {
  /// Places in `FlatScene::meshes` of those whose triangles were placed again, ascending.
  std::vector<std::uint32_t> placed_meshes;
  std::uint64_t placed_triangles = 0;
  /// Every number means the triangle that it meant before, moved or not.
  bool same_triangles = false;
  bool everything = false;  ///< materials, images and what is around them may be others, too
};

/// Brings `flat`, made by `flatten` or by this, to what `changes` made of `description`: the same,
/// bit for bit, as from scratch. Triangles that stay where they are stay as they are. O(what has
/// changed + instances). Throws as `flatten` does; `flat` is then good for nothing but
/// `changes.everything`.
[[nodiscard]] FlatUpdate update_flat(const Executor& executor, const SceneDescription& description,
                                     const SceneChanges& changes,
                                     const std::vector<Sphere>& object_bounds, FlatScene* flat);

}  // namespace raysheaf
