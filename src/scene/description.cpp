// What can be told of a scene description by looking at it.
#include "base/vec.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

std::uint64_t SceneDescription::triangle_count() const {
  std::uint64_t count = 0;
  for (const Instance& instance : instances) {
    if (instance.mesh < meshes.size()) count += meshes[instance.mesh].triangles.size();
  }
  return count;
}

Box world_bounds(const SceneDescription& scene) {
  Box box;
  // Loaders ask before the scene is validated: what is out of range is left out.
  for (const Instance& instance : scene.instances) {
    if (instance.mesh >= scene.meshes.size()) continue;
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t vertex : triangle) {
        if (vertex >= mesh.positions.size()) continue;
        const Vec3 p = transform_point(instance.to_world, mesh.positions[vertex]);
        box.min = min(box.min, p);
        box.max = max(box.max, p);
      }
    }
  }
  return box;
}

}  // namespace raysheaf
