// Once a mesh: the ball that its instances carry with them.
#include "exec/executor.h"
#include "geom/miniball.h"
#include "scene/flat_scene.h"

namespace raysheaf {
namespace {

std::vector<Vec3> used_positions(const Mesh& mesh) {
  std::vector<char> used(mesh.positions.size(), 0);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) used[vertex] = 1;
  }
  std::vector<Vec3> positions;
  positions.reserve(mesh.positions.size());
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] != 0) positions.push_back(mesh.positions[i]);
  }
  return positions;
}

}  // namespace

std::vector<Sphere> mesh_bounds(const Executor& executor, const SceneDescription& scene) {
  std::vector<Sphere> bounds(scene.meshes.size());
  executor.for_each(bounds.size(), 1, [&](std::size_t i) {
    const std::vector<Vec3> positions = used_positions(scene.meshes[i]);
    bounds[i] = miniball({positions.data(), positions.size()});
  });
  return bounds;
}

}  // namespace raysheaf
