// Queries about a scene description.
#include <algorithm>
#include <utility>
#include <vector>

#include "base/vec.h"
#include "raysheaf/scene_description.h"
#include "scene/flatten_body.h"
#include "scene/placing.h"

namespace raysheaf {
namespace {

void enlarge(Box* box, Vec3 p) {
  box->min = min(box->min, p);
  box->max = max(box->max, p);
}

bool is_empty(const Box& box) {
  return box.min.x > box.max.x;
}
bool contains(const Box& outer, const Box& inner) {
  return max(outer.min, inner.min) == inner.min && min(outer.max, inner.max) == inner.max;
}

std::size_t place_in(const std::vector<Box>& boxes, std::vector<Box>::const_iterator one) {
  return static_cast<std::size_t>(one - boxes.begin());
}

/// A box around each instance; empty where the mesh is shown only once, so that its own box would
/// not be worth computing. Loaders call this before the scene is validated: indices out of range
/// are skipped.
std::vector<Box> outer_boxes(const SceneDescription& scene) {
  std::vector<std::uint32_t> uses(scene.meshes.size());
  for (const Instance& instance : scene.instances)
    if (instance.mesh < uses.size()) ++uses[instance.mesh];
  std::vector<Box> meshes(scene.meshes.size());
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (uses[m] < 2) continue;
    for (const auto& triangle : scene.meshes[m].triangles)
      for (const std::uint32_t vertex : triangle)
        if (vertex < scene.meshes[m].positions.size())
          enlarge(&meshes[m], scene.meshes[m].positions[vertex]);
  }
  std::vector<Box> boxes(scene.instances.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (instance.mesh >= uses.size() || is_empty(meshes[instance.mesh])) continue;
    const Box& box = meshes[instance.mesh];
    boxes[i] = placed_box(make_placing(instance.to_world, box), box);
  }
  return boxes;
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
  const std::vector<Box> outer = outer_boxes(scene);
  std::vector<std::uint8_t> is_in(outer.size());
  Box with_area, all;
  const auto add = [&](std::size_t i) {
    const Instance& instance = scene.instances[i];
    if (std::exchange(is_in[i], 1) != 0 || instance.mesh >= scene.meshes.size()) return;
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
  };
  for (std::size_t i = 0; i < outer.size(); ++i)
    if (is_empty(outer[i])) add(i);
  // Once those that reach farthest are known, most of many instances are inside.
  for (int axis = 0; axis < 3 && !outer.empty(); ++axis) {
    const auto least = [axis](const Box& a, const Box& b) {
      return component(a.min, axis) < component(b.min, axis);
    };
    const auto greatest = [axis](const Box& a, const Box& b) {
      return component(a.max, axis) < component(b.max, axis);
    };
    add(place_in(outer, std::min_element(outer.begin(), outer.end(), least)));
    add(place_in(outer, std::max_element(outer.begin(), outer.end(), greatest)));
  }
  for (std::size_t i = 0; i < outer.size(); ++i)
    if (!contains(with_area, outer[i])) add(i);
  return with_area.min.x <= with_area.max.x ? with_area : all;
}

}  // namespace raysheaf
