// Changes of a scene: errors are found before anything changes.
#include <algorithm>
#include <cmath>

#include "api/scene/scene_impl.h"

namespace raysheaf {
namespace {

std::string mesh_name(MeshId id) {
  return "meshes[" + std::to_string(id) + "]";
}
std::string instance_name(InstanceId id) {
  return "instances[" + std::to_string(id) + "]";
}

bool is_finite(const Affine& transform) {
  for (const auto& row : transform.m)
    if (!std::all_of(row.begin(), row.end(), [](float x) { return std::isfinite(x); }))
      return false;
  return true;
}

void check(const Affine& transform, const std::string& place) {
  if (!is_finite(transform))
    throw Error(ErrorCode::kInvalidArgument, "the transform is not finite", place + ".transform");
}

/// `reserve` by itself would copy the list at each of many additions.
template <class T>
void make_room(std::vector<T>* list, std::size_t more) {
  if (list->capacity() - list->size() < more)
    list->reserve(std::max(2 * list->size(), list->size() + more));
}

/// Finds an id; distinguishes removed ids from ids that never existed.
template <class Map>
auto& found_in(Map& map, std::uint32_t id, std::uint32_t next_id, const char* what,
               std::string (*name)(std::uint32_t)) {
  const auto found = map.find(id);
  if (found != map.end()) return found->second;
  throw Error(ErrorCode::kNotFound,
              id < next_id ? std::string("this ") + what + " was removed"
                           : std::string("there is no such ") + what,
              name(id));
}

}  // namespace

const MeshEntry& Scene::Impl::mesh(MeshId id) const {
  return found_in(meshes, id, next_mesh_, "mesh", mesh_name);
}
MeshEntry& Scene::Impl::find(MeshId id) {
  return found_in(meshes, id, next_mesh_, "mesh", mesh_name);
}
const Placement& Scene::Impl::placement(InstanceId id) const {
  return found_in(placements, id, next_instance_, "instance", instance_name);
}
Placement& Scene::Impl::find_instance(InstanceId id) {
  return found_in(placements, id, next_instance_, "instance", instance_name);
}

void Scene::Impl::check_new_ids(bool mesh, bool instance) const {
  if ((mesh && next_mesh_ == kInvalidId) || (instance && next_instance_ == kInvalidId))
    throw Error(ErrorCode::kUnsupported, "the scene has used up its 2^32 - 1 ids", "scene");
}

MeshId Scene::Impl::add(View<const Vec3> positions, const View<const Triangle>* triangles,
                        const MeshOptions& options) {
  check_new_ids(true, options.place);
  const MeshId id = next_mesh_;
  check(options.transform, mesh_name(id));
  MeshEntry entry{id, MeshArrays(options.storage), {}, 0, -1};
  entry.arrays.set(executor(), positions, triangles, mesh_name(id));
  MeshEntry& mesh = meshes.emplace(id, std::move(entry)).first->second;
  set_shape(&mesh);
  try {
    if (options.place) place(&mesh, options.transform, options.mask);
  } catch (...) {
    meshes.erase(id);
    throw;
  }
  ++next_mesh_;
  committed = false;
  return id;
}

void Scene::Impl::set_shape(MeshEntry* mesh) {
  mesh->shape = ++last_shape_;
  mesh->reach = -1;
}

/// Reserves memory first; then the change cannot fail.
void Scene::Impl::place(MeshEntry* mesh, const Affine& transform, std::uint32_t mask) {
  make_room(&mesh->instances, 1);
  make_room(&stale_, 1);
  Placement& placement = placements[next_instance_];
  placement.id = next_instance_;
  placement.mesh = mesh;
  placement.to_world = transform;
  placement.mask = mask;
  mark_moved(&placement);
  mesh->instances.push_back(&placement);
  ++next_instance_;
  structure_changed_ = true;
  committed = false;
}

void Scene::Impl::mark_moved(Placement* placement) {
  if (placement->stale) return;
  stale_.push_back(placement->id);
  placement->stale = true;
}

void Scene::Impl::replace(MeshId id, View<const Vec3> positions,
                          const View<const Triangle>* triangles) {
  MeshEntry& mesh = find(id);
  make_room(&stale_, mesh.instances.size());
  mesh.arrays.set(executor(), positions, triangles, mesh_name(id));
  set_shape(&mesh);
  for (Placement* placement : mesh.instances) mark_moved(placement);
  structure_changed_ = structure_changed_ || !mesh.instances.empty();
  committed = false;
}

void Scene::Impl::update(MeshId id, View<const Vec3> positions) {
  MeshEntry& mesh = find(id);
  make_room(&stale_, mesh.instances.size());
  mesh.arrays.move(executor(), positions, mesh_name(id));
  set_shape(&mesh);
  for (Placement* placement : mesh.instances) mark_moved(placement);
  committed = false;
}

void Scene::Impl::remove(MeshId id) {
  const MeshEntry& mesh = find(id);
  structure_changed_ = structure_changed_ || !mesh.instances.empty();
  for (const Placement* placement : mesh.instances) placements.erase(placement->id);
  meshes.erase(id);
  committed = false;
}

InstanceId Scene::Impl::instance(MeshId id, const Affine& transform, std::uint32_t mask) {
  MeshEntry& mesh = find(id);
  check_new_ids(false, true);
  check(transform, instance_name(next_instance_));
  place(&mesh, transform, mask);
  return next_instance_ - 1;
}

void Scene::Impl::remove_instance(InstanceId id) {
  Placement& placement = find_instance(id);
  std::vector<Placement*>& siblings = placement.mesh->instances;
  siblings.erase(std::ranges::lower_bound(siblings, id, {}, &Placement::id));
  placements.erase(id);
  structure_changed_ = true;
  committed = false;
}

void Scene::Impl::set_transforms(View<const InstanceId> instances, View<const Affine> transforms) {
  if (instances.size != transforms.size)
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(transforms.size) + " transforms for " +
                    std::to_string(instances.size) + " instances",
                "transforms");
  std::vector<Placement*> moved;
  moved.reserve(instances.size);
  for (std::size_t i = 0; i < instances.size; ++i) {
    moved.push_back(&find_instance(instances[i]));
    if (!is_finite(transforms[i])) check(transforms[i], instance_name(instances[i]));
  }
  make_room(&stale_, moved.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    mark_moved(moved[i]);
    moved[i]->to_world = transforms[i];
  }
  if (!moved.empty()) committed = false;
}

void Scene::Impl::set_mask(InstanceId id, std::uint32_t mask) {
  Placement& placement = find_instance(id);
  if (placement.mask == mask) return;
  placement.mask = mask;
  masks_changed_ = true;
  committed = false;
}

}  // namespace raysheaf
