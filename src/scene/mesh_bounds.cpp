// The bounding sphere of each mesh, computed once and transformed with its instances.
#include <algorithm>

#include "exec/executor.h"
#include "geom/miniball.h"
#include "scene/flat_update.h"
#include "scene/mesh_bound_body.h"

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

Sphere shape_bound(const Mesh& mesh) {
  if (mesh.triangles.empty()) return {};
  Box box;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      box.min = min(box.min, mesh.positions[vertex]);
      box.max = max(box.max, mesh.positions[vertex]);
    }
  }
  const Vec3 center = shape_center(box);
  double squared = 0;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle)
      squared = std::max(squared, squared_distance_in_double(mesh.positions[vertex], center));
  return shape_sphere(center, squared);
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
  if (!changes.everything)
    for (const std::uint32_t m : changes.deformed)
      if (m < other) stale.push_back(m);
  const std::size_t deformed = stale.size();
  for (std::size_t m = other; m < count; ++m) stale.push_back(static_cast<std::uint32_t>(m));
  bounds->resize(count);
  executor.for_each(stale.size(), 1, [&](std::size_t i) {
    const Mesh& mesh = scene.meshes[stale[i]];
    (*bounds)[stale[i]] = i < deformed ? shape_bound(mesh) : mesh_bound(mesh);
  });
  return static_cast<std::uint32_t>(stale.size());
}

}  // namespace raysheaf
