// Places the instances of a scene description in world space.
#include <algorithm>
#include <numeric>
#include <string>

#include "base/mirrors_body.h"
#include "exec/executor.h"
#include "exec/for_each_part.h"
#include "raysheaf/error.h"
#include "scene/flat_update.h"
#include "scene/material_of.h"
#include "scene/mesh_bound_body.h"
#include "scene/shown_name.h"

namespace raysheaf {
namespace {

/// The instances that have triangles, sorted by (geom_id, inst_id).
std::vector<std::uint32_t> ordered_instances(const SceneDescription& scene) {
  std::vector<std::uint32_t> order(scene.instances.size());
  std::iota(order.begin(), order.end(), 0u);
  std::erase_if(order, [&](std::uint32_t i) {
    return scene.meshes[scene.instances[i].mesh].triangles.empty();
  });
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return scene.instances[a].mesh < scene.instances[b].mesh;
  });
  return order;
}

FlatMesh flat_mesh(const SceneDescription& scene, std::uint32_t inst_id, const Sphere& object_bound,
                   std::uint32_t first_triangle) {
  const Instance& instance = scene.instances[inst_id];
  FlatMesh mesh;
  mesh.first_triangle = first_triangle;
  mesh.triangle_count = static_cast<std::uint32_t>(scene.meshes[instance.mesh].triangles.size());
  mesh.geom_id = instance.mesh;
  mesh.inst_id = inst_id;
  mesh.mirrored = mirrors(instance.to_world);
  mesh.bound = transformed(object_bound, instance.to_world);
  // If a mesh is huge in a direction that its instance flattens, the largest stretch overestimates
  // the radius. No two points of the scene are farther apart than this.
  mesh.bound.radius = std::min(mesh.bound.radius, 4 * kLargestCoordinate);
  return mesh;
}

void grow(Box* box, const Box& by) {
  box->min = min(box->min, by.min);
  box->max = max(box->max, by.max);
}

PlacedInstance placed_instance(const SceneDescription& scene, const FlatMesh& mesh) {
  const Mesh& shape = scene.meshes[mesh.geom_id];
  PlacedInstance placed;
  placed.positions = View<const Vec3>(shape.positions);
  placed.triangles = shape.triangles.data();
  placed.triangle_count = mesh.triangle_count;
  placed.geom_id = mesh.geom_id;
  placed.inst_id = mesh.inst_id;
  placed.to_world = scene.instances[mesh.inst_id].to_world;
  return placed;
}

std::uint8_t flags_of(const SceneDescription& scene, std::uint32_t material, bool mirrored) {
  return static_cast<std::uint8_t>(
      (material_or_default(scene, material).double_sided ? 0 : kSingleSided) |
      (mirrored ? kMirrored : 0));
}

/// Sets the flags of the triangles [begin, end) of a mesh.
void set_flags(const SceneDescription& scene, const FlatMesh& placed, std::size_t begin,
               std::size_t end, std::uint8_t* flags) {
  const Mesh& mesh = scene.meshes[placed.geom_id];
  std::uint8_t* const out = flags + placed.first_triangle;
  if (mesh.materials.size() <= 1) {
    std::fill(out + begin, out + end, flags_of(scene, material_of(mesh, 0), placed.mirrored));
    return;
  }
  for (std::size_t i = begin; i < end; ++i)
    out[i] = flags_of(scene, material_of(mesh, static_cast<std::uint32_t>(i)), placed.mirrored);
}

[[noreturn]] void throw_refused(const SceneDescription& scene, std::uint32_t inst_id) {
  const Instance& instance = scene.instances[inst_id];
  throw Error(ErrorCode::kInvalidData,
              "the transform" + of_name(instance.name) + " puts a vertex of meshes[" +
                  std::to_string(instance.mesh) + "] farther out than 1e18",
              "instances[" + std::to_string(inst_id) + "].to_world");
}

/// The number of triangles of all instances; throws if it is too large.
std::uint32_t checked_count(const SceneDescription& description) {
  const std::uint64_t count = description.triangle_count();
  if (count > kMostFlatTriangles) {
    throw Error(ErrorCode::kUnsupported,
                "the scene has " + std::to_string(count) +
                    " triangles, more than 2^31 - 64: only dual on the CPU, with traced primary "
                    "rays and without tests per pixel, renders so many");
  }
  return static_cast<std::uint32_t>(count);
}

/// The range of triangles of each instance, with its ids; everything else is filled later.
std::vector<FlatMesh> layout(const SceneDescription& description) {
  std::vector<FlatMesh> meshes;
  std::uint32_t first_triangle = 0;
  for (const std::uint32_t inst_id : ordered_instances(description)) {
    FlatMesh mesh;
    mesh.geom_id = description.instances[inst_id].mesh;
    mesh.inst_id = inst_id;
    mesh.first_triangle = first_triangle;
    mesh.triangle_count =
        static_cast<std::uint32_t>(description.meshes[mesh.geom_id].triangles.size());
    first_triangle += mesh.triangle_count;
    meshes.push_back(mesh);
  }
  return meshes;
}

/// Places the triangles of the meshes at the indices `places` in `flat->meshes`, and finds the box
/// of the scene.
void place(const Executor& executor, const std::vector<Sphere>& object_bounds,
           const std::vector<std::uint32_t>& places, FlatScene* flat) {
  const SceneDescription& description = *flat->description;
  for (const std::uint32_t i : places) {
    FlatMesh& mesh = flat->meshes[i];
    mesh = flat_mesh(description, mesh.inst_id, object_bounds[mesh.geom_id], mesh.first_triangle);
  }
  const std::uint32_t refused = flat->placed.place(executor, View<const std::uint32_t>(places));
  if (refused != kInvalidId) throw_refused(description, refused);
  std::vector<TriangleRun> runs;
  std::vector<std::size_t> sizes;
  for (const std::uint32_t i : places) {
    runs.push_back(flat->placed.runs()[i]);
    sizes.push_back(runs.back().count);
  }
  const std::vector<Box> boxes = boxes_of(executor, View<const TriangleRun>(runs));
  for (std::size_t i = 0; i < places.size(); ++i) flat->meshes[places[i]].box = boxes[i];
  for_each_part(executor, sizes, [&](std::size_t i, std::size_t begin, std::size_t end) {
    set_flags(description, flat->meshes[places[i]], begin, end, flat->flags.data());
  });
  flat->bounds = {};
  for (const FlatMesh& mesh : flat->meshes) grow(&flat->bounds, mesh.box);
}

/// Makes room for the triangles of `flat->meshes`, and numbers them.
void list(const Executor& executor, FlatScene* flat) {
  const std::uint32_t count = checked_count(*flat->description);
  flat->triangle_count = count;
  flat->flags.resize(count);
  flat->mesh_of_triangle.resize(count);
  std::vector<std::size_t> sizes;
  std::vector<PlacedInstance> instances;
  for (const FlatMesh& mesh : flat->meshes) {
    sizes.push_back(mesh.triangle_count);
    instances.push_back(placed_instance(*flat->description, mesh));
  }
  flat->placed.list(std::move(instances));
  for_each_part(executor, sizes, [&](std::size_t i, std::size_t begin, std::size_t end) {
    std::uint32_t* const out = flat->mesh_of_triangle.data() + flat->meshes[i].first_triangle;
    std::fill(out + begin, out + end, static_cast<std::uint32_t>(i));
  });
}

/// Brings the placed instances to where the description is now, and how it transforms them.
void look_again(FlatScene* flat) {
  for (std::uint32_t i = 0; i < flat->meshes.size(); ++i)
    flat->placed.set(i, placed_instance(*flat->description, flat->meshes[i]));
}

/// Flags for the indices [from, count) and the listed ones.
std::vector<char> marked(const std::vector<std::uint32_t>& listed, std::uint32_t from,
                         std::size_t count) {
  std::vector<char> marks(count, 0);
  if (from < count) std::fill(marks.begin() + from, marks.end(), char{1});
  for (const std::uint32_t i : listed) marks[i] = 1;
  return marks;
}

bool stands(const FlatMesh& a, const FlatMesh& b) {
  return a.first_triangle == b.first_triangle && a.triangle_count == b.triangle_count &&
         a.geom_id == b.geom_id && a.inst_id == b.inst_id;
}

/// Lays out the meshes after the changes; returns the indices of those that must be filled.
std::vector<std::uint32_t> lay_out_again(const SceneDescription& description,
                                         const SceneChanges& changes, FlatScene* flat) {
  const std::uint32_t mesh_from = changes.everything ? 0 : changes.other_meshes_from;
  const std::uint32_t instance_from = changes.everything ? 0 : changes.other_instances_from;
  const bool same = mesh_from == kInvalidId && instance_from == kInvalidId;
  std::vector<FlatMesh> meshes = same ? flat->meshes : layout(description);
  const std::vector<char> mesh_marks =
      marked(changes.deformed, mesh_from, description.meshes.size());
  const std::vector<char> instance_marks =
      marked(changes.moved, instance_from, description.instances.size());
  std::vector<std::uint32_t> places;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const bool stays = i < flat->meshes.size() && stands(meshes[i], flat->meshes[i]) &&
                       mesh_marks[meshes[i].geom_id] == 0 && instance_marks[meshes[i].inst_id] == 0;
    if (stays) {
      meshes[i] = flat->meshes[i];
    } else {
      places.push_back(static_cast<std::uint32_t>(i));
    }
  }
  flat->meshes = std::move(meshes);
  return places;
}

void count_placed(const FlatScene& flat, FlatUpdate* update) {
  for (const std::uint32_t i : update->placed_meshes)
    update->placed_triangles += flat.meshes[i].triangle_count;
}

}  // namespace

FlatScene flatten(const Executor& executor, const SceneDescription& description,
                  const std::vector<Sphere>& object_bounds) {
  FlatScene flat;
  flat.description = &description;
  flat.meshes = layout(description);
  list(executor, &flat);
  std::vector<std::uint32_t> places(flat.meshes.size());
  std::iota(places.begin(), places.end(), 0u);
  place(executor, object_bounds, places, &flat);
  return flat;
}

FlatUpdate update_flat(const Executor& executor, const SceneDescription& description,
                       const SceneChanges& changes, const std::vector<Sphere>& object_bounds,
                       FlatScene* flat) {
  FlatUpdate update;
  flat->description = &description;
  update.placed_meshes = lay_out_again(description, changes, flat);
  const bool other = changes.everything || changes.other_meshes_from != kInvalidId ||
                     changes.other_instances_from != kInvalidId;
  update.same_triangles = !other;
  update.everything = changes.everything;
  if (other) {
    list(executor, flat);
  } else {
    look_again(flat);
  }
  place(executor, object_bounds, update.placed_meshes, flat);
  count_placed(*flat, &update);
  return update;
}

void list_standing(const SceneDescription& description, const std::vector<MeshShape>& shapes,
                   FlatScene* scene) {
  scene->description = &description;
  scene->stands = true;
  scene->meshes = layout(description);
  std::vector<PlacedInstance> instances;
  instances.reserve(scene->meshes.size());
  for (FlatMesh& mesh : scene->meshes) {
    mesh.mirrored = mirrors(description.instances[mesh.inst_id].to_world);
    PlacedInstance one = placed_instance(description, mesh);
    const MeshShape& shape = shapes[mesh.geom_id];
    one.inst_id = static_cast<std::uint32_t>(instances.size());
    one.shape = shape.version;
    one.flags = shape.flags.empty() ? nullptr : shape.flags.data();
    instances.push_back(one);
  }
  scene->placed.list(std::move(instances));
}

std::vector<std::uint8_t> shape_flags(const SceneDescription& description, const Mesh& mesh) {
  std::vector<std::uint8_t> flags(mesh.triangles.size());
  for (std::uint32_t i = 0; i < flags.size(); ++i)
    flags[i] = flags_of(description, material_of(mesh, i), false);
  const auto is_set = [](std::uint8_t flag) { return flag != 0; };
  return std::any_of(flags.begin(), flags.end(), is_set) ? flags : std::vector<std::uint8_t>();
}

FlatUpdate move_flat_meshes(const SceneDescription& description, const SceneChanges& changes,
                            const std::vector<Sphere>& object_bounds, FlatScene* flat) {
  FlatUpdate update;
  flat->description = &description;
  update.placed_meshes = lay_out_again(description, changes, flat);
  update.same_triangles = true;
  for (const std::uint32_t i : update.placed_meshes) {
    FlatMesh& mesh = flat->meshes[i];
    mesh = flat_mesh(description, mesh.inst_id, object_bounds[mesh.geom_id], mesh.first_triangle);
  }
  look_again(flat);
  count_placed(*flat, &update);
  return update;
}

}  // namespace raysheaf
