// Changes of a scene: errors are found before anything changes.
#include <algorithm>
#include <cmath>
#include <utility>

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

/// Throws unless there are as many of one as of the other.
void check_lengths(std::size_t given, const char* name, std::size_t expected, const char* of) {
  if (given == expected) return;
  throw Error(ErrorCode::kInvalidArgument,
              std::to_string(given) + " " + name + " for " + std::to_string(expected) + " " + of,
              name);
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

void Scene::Impl::check_new_ids(std::uint64_t new_meshes, std::uint64_t new_instances) const {
  if (new_meshes > kInvalidId - next_mesh_ || new_instances > kInvalidId - next_instance_)
    throw Error(ErrorCode::kUnsupported, "the scene has used up its 2^32 - 1 ids", "scene");
}

MeshId Scene::Impl::add(View<const Vec3> positions, const View<const Triangle>* triangles,
                        const MeshOptions& options) {
  check_new_ids(1, options.place ? 1 : 0);
  const MeshId id = next_mesh_;
  check(options.transform, mesh_name(id));
  MeshEntry entry{id, MeshArrays(options.storage), {}, 0, -1};
  entry.arrays.set(executor(), positions, triangles, mesh_name(id));
  MeshEntry& mesh = meshes.emplace(id, std::move(entry)).first->second;
  set_shape(&mesh);
  try {
    if (options.place) place(&mesh, {&options.transform, 1}, {&options.world, 1}, options.mask);
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

/// Takes memory first; then the change cannot fail. `worlds` is empty, or has one for each
/// transform.
void Scene::Impl::place(MeshEntry* mesh, View<const Affine> transforms, View<const WorldId> worlds,
                        std::uint32_t mask) {
  const auto count = static_cast<std::uint32_t>(transforms.size);
  make_room(&mesh->instances, count);
  make_room(&stale_, count);
  const std::size_t before = mesh->instances.size();
  try {
    for (std::uint32_t i = 0; i < count; ++i) {
      const InstanceId id = next_instance_ + i;
      const WorldId world = worlds.size == 0 ? kAllWorlds : worlds[i];
      const Placement one{id, mesh, transforms[i], {}, mask, world};
      mesh->instances.push_back(&placements.try_emplace(id, one).first->second);
    }
  } catch (...) {
    for (; mesh->instances.size() > before; mesh->instances.pop_back())
      placements.erase(mesh->instances.back()->id);
    throw;
  }
  for (std::uint32_t i = 0; i < count; ++i) mark_moved(mesh->instances[before + i]);
  next_instance_ += count;
  structure_changed_ = structure_changed_ || count != 0;
  committed = committed && count == 0;
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

void Scene::Impl::update(MeshId id, View<const View<const Vec3>> times) {
  MeshEntry& mesh = find(id);
  make_room(&stale_, mesh.instances.size());
  mesh.arrays.move(executor(), times, mesh_name(id));
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

InstanceId Scene::Impl::instances(MeshId id, View<const Affine> transforms,
                                  View<const WorldId> worlds, std::uint32_t mask) {
  MeshEntry& mesh = find(id);
  if (worlds.size != 0) check_lengths(worlds.size, "worlds", transforms.size, "transforms");
  check_new_ids(0, transforms.size);
  const InstanceId first = next_instance_;
  for (std::uint32_t i = 0; i < transforms.size; ++i)
    if (!is_finite(transforms[i])) check(transforms[i], instance_name(first + i));
  place(&mesh, transforms, worlds, mask);
  return first;
}

void Scene::Impl::remove_instance(InstanceId id) {
  Placement& placement = find_instance(id);
  std::vector<Placement*>& siblings = placement.mesh->instances;
  siblings.erase(std::ranges::lower_bound(siblings, id, {}, &Placement::id));
  placements.erase(id);
  structure_changed_ = true;
  committed = false;
}

void Scene::Impl::set_transforms(View<const InstanceId> instances, View<const Affine> transforms,
                                 std::size_t each) {
  if (each == 0 || transforms.size % each != 0 || transforms.size / each != instances.size)
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(transforms.size) + " transforms for " +
                    std::to_string(instances.size) + " instances" +
                    (each == 1 ? "" : ", " + std::to_string(each) + " each"),
                "transforms");
  std::vector<Placement*> moved;
  std::vector<std::vector<Affine>> motions(each > 1 ? instances.size : 0);
  moved.reserve(instances.size);
  for (std::size_t i = 0; i < instances.size; ++i) {
    moved.push_back(&find_instance(instances[i]));
    const View<const Affine> own = transforms.slice(i * each, each);
    for (const Affine& transform : own)
      if (!is_finite(transform)) check(transform, instance_name(instances[i]));
    if (each > 1) motions[i].assign(own.begin(), own.end());
  }
  make_room(&stale_, moved.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    mark_moved(moved[i]);
    moved[i]->to_world = transforms[i * each];
    if (each > 1)
      moved[i]->motion = std::move(motions[i]);
    else
      moved[i]->motion.clear();
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

void Scene::Impl::set_world(InstanceId id, WorldId world) {
  Placement& placement = find_instance(id);
  if (placement.world == world) return;
  placement.world = world;
  worlds_changed_ = true;
  committed = false;
}

}  // namespace raysheaf
