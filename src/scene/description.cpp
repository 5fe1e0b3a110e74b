// Queries about a scene description.
#include "base/vec.h"
#include "raysheaf/scene_description.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

void enlarge(Box* box, Vec3 p) {
  box->min = min(box->min, p);
  box->max = max(box->max, p);
}

}  // namespace

std::uint64_t SceneDescription::triangle_count() const {
  std::uint64_t count = 0;
  for (const Instance& instance : instances) {
    if (instance.mesh < meshes.size()) count += meshes[instance.mesh].triangles.size();
  }
  return count;
}

Box world_bounds(const SceneDescription& scene) {
  Box with_area, all;
  // Loaders call this before the scene is validated: indices out of range are skipped.
  for (const Instance& instance : scene.instances) {
    if (instance.mesh >= scene.meshes.size()) continue;
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (const auto& triangle : mesh.triangles) {
      Vec3 corner[3];
      std::size_t known = 0;
      for (const std::uint32_t vertex : triangle) {
        if (vertex >= mesh.positions.size()) continue;
        corner[known] = transform_point(instance.to_world, mesh.positions[vertex]);
        enlarge(&all, corner[known++]);
      }
      if (known < 3 || has_no_area(corner[0], corner[1], corner[2])) continue;
      for (const Vec3 p : corner) enlarge(&with_area, p);
    }
  }
  return with_area.min.x <= with_area.max.x ? with_area : all;
}

}  // namespace raysheaf
