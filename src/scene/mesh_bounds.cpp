// The bounding sphere of each mesh, computed once and transformed with its instances.
#include <algorithm>

#include "exec/executor.h"
#include "geom/miniball.h"
#include "scene/flat_update.h"

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

Sphere mesh_bound(const Mesh& mesh) {
  const std::vector<Vec3> positions = used_positions(mesh);
  return miniball({positions.data(), positions.size()});
}

std::vector<Sphere> mesh_bounds(const Executor& executor, const SceneDescription& scene) {
  std::vector<Sphere> bounds(scene.meshes.size());
  executor.for_each(bounds.size(), 1,
                    [&](std::size_t i) { bounds[i] = mesh_bound(scene.meshes[i]); });
  return bounds;
}

std::uint32_t update_bounds(const Executor& executor, const SceneDescription& scene,
                            const SceneChanges& changes, std::vector<Sphere>* bounds) {
  const std::size_t count = scene.meshes.size();
  const std::size_t other =
      changes.everything ? 0 : std::min<std::size_t>(changes.other_meshes_from, count);
  std::vector<std::uint32_t> stale;
  for (const std::uint32_t m : changes.deformed)
    if (m < other) stale.push_back(m);
  for (std::size_t m = other; m < count; ++m) stale.push_back(static_cast<std::uint32_t>(m));
  bounds->resize(count);
  executor.for_each(stale.size(), 1, [&](std::size_t i) {
    (*bounds)[stale[i]] = mesh_bound(scene.meshes[stale[i]]);
  });
  return static_cast<std::uint32_t>(stale.size());
}

}  // namespace raysheaf
