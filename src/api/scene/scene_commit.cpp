// Applies the changes of a scene to what queries see.
#include <algorithm>
#include <cmath>
#include <mutex>

#include "api/scene/scene_impl.h"
#include "base/vec.h"
#include "scene/placed_bounds.h"
#include "scene/transform_points.h"

namespace raysheaf {
namespace {

PlacedInstance placed_instance(const Placement& placement) {
  const MeshArrays& arrays = placement.mesh->arrays;
  PlacedInstance placed{arrays.positions(),   arrays.triangles(), arrays.triangle_count(),
                        placement.mesh->id,   placement.id,       placement.to_world,
                        placement.mesh->shape};
  placed.motion = placement.motion;
  if (arrays.times().size > 1) placed.times = arrays.times();
  return placed;
}

/// At least the largest coordinate of a corner. Vertices that no triangle uses may be anything.
double reach_of(const Executor& executor, View<const Vec3> positions) {
  std::mutex mutex;
  float reach = 0;
  executor.for_each_block(positions.size, kCopyGrain, [&](std::size_t begin, std::size_t end) {
    float some = 0;
    for (const Vec3 p : positions.slice(begin, end - begin)) {
      const float size = max_component(abs(p));
      if (size <= kLargestCoordinate && size > some) some = size;
    }
    const std::lock_guard lock(mutex);
    reach = std::max(reach, some);
  });
  return reach;
}

}  // namespace

void Scene::Impl::commit() {
  if (committed) return;
  const std::vector<Placement*> moved = moved_placements();
  if (structure_changed_) list_runs();
  place_runs(moved);
  if (structure_changed_) ++runs.structure_version;
  if (!moved.empty()) ++runs.position_version;
  if (structure_changed_ || masks_changed_ || worlds_changed_) list_marks();
  if (structure_changed_ || masks_changed_) {
    ++runs.mask_version;
    views.forget_old_masks(runs);
  }
  if (worlds_changed_) ++runs.world_version;
  for (Placement* placement : moved) placement->stale = false;
  stale_.clear();
  structure_changed_ = masks_changed_ = worlds_changed_ = false;
  bounds_.reset();
  committed = true;
}

/// Those of `stale_` that still exist.
std::vector<Placement*> Scene::Impl::moved_placements() {
  std::vector<Placement*> moved;
  moved.reserve(stale_.size());
  for (const InstanceId id : stale_) {
    const auto found = placements.find(id);
    if (found != placements.end()) moved.push_back(&found->second);
  }
  return moved;
}

/// Makes all runs again, sorted by (mesh, instance).
void Scene::Impl::list_runs() {
  std::vector<PlacedInstance> instances;
  instances.reserve(placements.size());
  for (const auto& [id, mesh] : meshes) {
    for (Placement* placement : mesh.instances) {
      placement->run = Placement::kNoRun;
      if (mesh.arrays.triangle_count() == 0) continue;
      placement->run = static_cast<std::uint32_t>(instances.size());
      instances.push_back(placed_instance(*placement));
    }
  }
  runs.notes.assign(instances.size(), {});
  runs.placed.list(std::move(instances));
}

/// Whether the transform surely leaves all vertices of triangles within the world. Finds the reach
/// of the mesh the first time.
bool Scene::Impl::stays_in_world(MeshEntry* mesh, const Affine& to_world) {
  if (mesh->reach < 0)
    for (const View<const Vec3> positions : mesh->arrays.times())
      mesh->reach = std::max(mesh->reach, reach_of(executor(), positions));
  for (const auto& m : to_world.m) {
    const double sum = std::fabs(static_cast<double>(m[0])) + std::fabs(static_cast<double>(m[1])) +
                       std::fabs(static_cast<double>(m[2]));
    if (!(sum * mesh->reach + std::fabs(static_cast<double>(m[3])) <= 0.999 * kLargestCoordinate))
      return false;
  }
  return true;
}

/// Tells runs of instances that have moved where they stand. Most wait for a query that reads their
/// vertices.
void Scene::Impl::place_runs(const std::vector<Placement*>& moved) {
  std::vector<std::uint32_t> numbers;
  numbers.reserve(moved.size());
  for (const Placement* placement : moved) {
    if (placement->run == Placement::kNoRun) continue;
    const PlacedInstance placed = placed_instance(*placement);
    const auto stays = [&](const Affine& map) { return stays_in_world(placement->mesh, map); };
    const bool waits = placed.is_identity() || stays(placed.to_world);
    if (!std::ranges::all_of(placement->motion, stays) || (!waits && !placed.times.empty()))
      throw Error(ErrorCode::kInvalidData,
                  "a transform may put a vertex of meshes[" + std::to_string(placement->mesh->id) +
                      "] farther out than 1e18 at some time",
                  "instances[" + std::to_string(placement->id) + "].transform");
    runs.placed.set(placement->run, placed);
    if (waits)
      runs.placed.let_wait(placement->run);
    else
      numbers.push_back(placement->run);
    runs.notes[placement->run].moved_at = runs.position_version + 1;
  }
  const InstanceId refused = runs.placed.place(executor(), View<const std::uint32_t>(numbers));
  if (refused == kInvalidId) return;
  throw Error(ErrorCode::kInvalidData,
              "the transform puts a vertex of meshes[" +
                  std::to_string(placement(refused).mesh->id) + "] farther out than 1e18",
              "instances[" + std::to_string(refused) + "].transform");
}

/// The masks and the worlds.
void Scene::Impl::list_marks() {
  runs.masks.clear();
  runs.has_worlds = false;
  for (std::size_t i = 0; i < runs.notes.size(); ++i) {
    const Placement& placement = placements.at(runs.placed.instances()[i].inst_id);
    const std::uint32_t mask = placement.mask;
    runs.notes[i].mask = mask;
    runs.notes[i].world = placement.world;
    runs.has_worlds = runs.has_worlds || placement.world != kAllWorlds;
    // Usually there are few distinct masks.
    if (runs.masks.empty() || runs.masks.back() != mask) runs.masks.push_back(mask);
  }
  std::sort(runs.masks.begin(), runs.masks.end());
  runs.masks.erase(std::unique(runs.masks.begin(), runs.masks.end()), runs.masks.end());
}

void Scene::Impl::require_committed() const {
  if (!committed)
    throw Error(ErrorCode::kWrongState, "the scene has changes that wait for commit()", "scene");
}

Box Scene::Impl::bounds() {
  require_committed();
  Box box;
  executor().enter([&] {
    const std::lock_guard lock(bounds_mutex_);
    if (!bounds_) bounds_ = placed_bounds(executor().alone(), runs.placed.instances());
    box = *bounds_;
  });
  return box;
}

std::size_t Scene::Impl::memory_bytes() {
  std::size_t bytes = views.memory_bytes() + levels.memory_bytes() + runs.memory_bytes();
  for (const auto& [id, mesh] : meshes)
    bytes += sizeof(mesh) + mesh.arrays.memory_bytes() + mesh.instances.capacity() * sizeof(void*);
  bytes += placements.size() * sizeof(Placement);
  return bytes;
}

}  // namespace raysheaf
