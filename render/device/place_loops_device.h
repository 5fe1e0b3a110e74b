// Instances that move, placed on a device: `flatten` (scene/flat_scene.h) as loops; for the sources
// that know which device it is.
#pragma once

#include <cstdint>

#include "base/mirrors_body.h"
#include "base/view.h"
#include "exec/device.h"
#include "object_tree/linear_tree_body.h"
#include "render/device/staged_scene.h"
#include "scene/flatten_body.h"

namespace raysheaf {

/// All that is sent of an instance which stands elsewhere.
struct MovedMesh {
  std::uint32_t place = 0;  ///< in the flat scene's meshes
  Affine to_world;
};

/// The result: the box of all triangles, and the first mesh that cannot be placed. All bits
/// set before.
struct PlacedBounds {
  SharedBox box;
  std::uint32_t refused;
};

/// Where triangles come from and go to.
struct TrianglesToPlace {
  const Vec3* positions = nullptr;   ///< of vertices, in their meshes' own space
  const Affine* to_world = nullptr;  ///< of each mesh
  View<Vec3> corners;
  View<std::uint8_t> flags;
};

/// `to_world`, `meshes`: of all, brought up to date.
template <class Device>
void move_meshes_on(Device& device, View<const MovedMesh> moved, Affine* to_world,
                    StagedMesh* meshes) {
  device.for_each("scene: move", moved.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const MovedMesh& now = moved.data[i];
    StagedMesh& mesh = meshes[now.place];
    to_world[now.place] = now.to_world;
    mesh.mirrored = mirrors(now.to_world);
    mesh.normal_map = normal_map(now.to_world);
  });
}

/// All triangles, those that stay too: they are the same bits again.
template <class Device>
void place_triangles_on(Device& device, const StagedSceneView& scene, const TrianglesToPlace& to,
                        PlacedBounds* bounds) {
  device.for_each("scene: place", to.flags.size, [=] RAYSHEAF_DEVICE(std::size_t i) {
    const std::uint32_t number = scene.mesh_of_triangle.data[i];
    const StagedMesh& mesh = scene.meshes.data[number];
    const StagedTriangle vertices =
        scene.triangles.data[mesh.first_index + (i - mesh.first_triangle)];
    Vec3 corner[3];
    for (int k = 0; k < 3; ++k)
      corner[k] = to.positions[std::size_t{mesh.first_position} + vertices.vertex[k]];
    if (!place_corners(to.to_world[number], corner)) return lower_to(&bounds->refused, number);
    enlarge(&bounds->box, triangle_box(corner[0], corner[1], corner[2]));
    collapse_flat(corner);
    for (std::size_t k = 0; k < 3; ++k) to.corners.data[3 * i + k] = corner[k];
    to.flags.data[i] = static_cast<std::uint8_t>((to.flags.data[i] & kSingleSided) |
                                                 (mesh.mirrored ? kMirrored : 0));
  });
}

}  // namespace raysheaf
