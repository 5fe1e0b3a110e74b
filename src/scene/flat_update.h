// Updates a flat scene after changes of its description, without recomputing what has not changed.
#pragma once

#include <cstdint>
#include <vector>

#include "raysheaf/scene_changes.h"
#include "scene/flat_scene.h"

namespace raysheaf {

/// The sphere of one mesh, as computed by `mesh_bounds`.
[[nodiscard]] Sphere mesh_bound(const Mesh& mesh);
/// The sphere of a mesh that changes its shape (scene/mesh_bound_body.h), which devices find, too.
/// O(triangles).
[[nodiscard]] Sphere shape_bound(const Mesh& mesh);

/// Updates the spheres after `changes` of `scene`: those of meshes that keep their shape stay,
/// deformed meshes get their `shape_bound` and new ones their `mesh_bound`. Returns how many were
/// computed.
std::uint32_t update_bounds(const Executor& executor, const SceneDescription& scene,
                            const SceneChanges& changes, std::vector<Sphere>* bounds);

/// The work of `update_flat`.
struct FlatUpdate {
  /// Indices in `FlatScene::meshes` of those whose triangles were transformed again, ascending.
  std::vector<std::uint32_t> placed_meshes;
  std::uint64_t placed_triangles = 0;
  /// Every number still denotes the same triangle, moved or not.
  bool same_triangles = false;
  bool everything = false;  ///< materials, images and everything else may have changed, too
};

/// Updates `flat`, made by `flatten` or by this function, after `changes` of `description`, to the
/// same bits as `flatten`. Triangles that do not move are not recomputed. O(changes + instances).
/// Throws as `flatten` does; `flat` may then only be used with `changes.everything`.
[[nodiscard]] FlatUpdate update_flat(const Executor& executor, const SceneDescription& description,
                                     const SceneChanges& changes,
                                     const std::vector<Sphere>& object_bounds, FlatScene* flat);

/// The same for a device that places the triangles itself: brings `FlatScene::meshes`, except for
/// their boxes, to what `changes` made of `description`: moved instances and deformed meshes only.
/// The boxes, `bounds` and all arrays stay as they were, until `update_flat` is called with the
/// same changes. O(instances + meshes).
[[nodiscard]] FlatUpdate move_flat_meshes(const SceneDescription& description,
                                          const SceneChanges& changes,
                                          const std::vector<Sphere>& object_bounds,
                                          FlatScene* flat);

}  // namespace raysheaf
