#include "render/shown_scene.h"

#include <algorithm>
#include <utility>

#include "exec/stopwatch.h"
#include "render/device/frame_stages.h"

namespace raysheaf {
namespace {

/// Whether nothing changes but where instances stand and which shapes meshes have.
bool is_motion(const SceneChanges& changes) {
  return !changes.everything && changes.other_meshes_from == kInvalidId &&
         changes.other_instances_from == kInvalidId;
}

/// The meshes that are posed, ascending.
std::vector<std::uint32_t> posed_meshes(const SceneChanges& changes) {
  std::vector<std::uint32_t> meshes;
  for (const MeshPose& pose : changes.posed) meshes.push_back(pose.shape->mesh);
  std::sort(meshes.begin(), meshes.end());
  return meshes;
}

std::string counted(std::size_t count, const std::string& thing, const char* plural = "s") {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : plural);
}

}  // namespace

void ShownScene::validate() const {
  if (pending_.everything) {  // vertices of a former pose may be the ones that were refused
    if (behind_.move_vertices) behind_.move_vertices();
    if (pending_.move_vertices) pending_.move_vertices();
  }
  SceneChanges known = pending_;
  const std::vector<std::uint32_t> posed = posed_meshes(pending_);
  std::erase_if(known.deformed, [&](std::uint32_t mesh) {
    return std::binary_search(posed.begin(), posed.end(), mesh);
  });
  validate_changes(*scene_, known);
}

/// And checks them, as `validate` does those that the scene has.
void ShownScene::move_vertices(const SceneChanges& changes) const {
  if (!changes.move_vertices) return;
  changes.move_vertices();
  SceneChanges moved;
  moved.deformed = posed_meshes(changes);
  validate_changes(*scene_, moved);
}

void ShownScene::settle(std::string host_need, bool by_spheres, std::uint64_t entering) {
  by_spheres_ = by_spheres;
  entering_ = entering;
  const bool motion = is_motion(pending_);
  if (host_need.empty() && posed_meshes(pending_) != pending_.deformed)
    host_need = "meshes change their shapes there";
  there_ = motion && host_need.empty() && cache_.stages != nullptr && cache_.stages->has_scene();
  placing_.clear();
  if (!there_ && motion && !pending_.empty() && cache_.backend != nullptr)
    placing_ = "device: the host places what moves, for " + host_need;
  if (there_) return;
  move_vertices(behind_);
  move_vertices(pending_);
}

UpdateStatistics ShownScene::update(const Executor& executor) {
  const SceneChanges changes = std::exchange(pending_, {});
  pending_.everything = true;
  UpdateStatistics update = count_changes(changes);
  entered_.note(*scene_, changes);
  cache_.entered.reset();
  if (there_)
    place_there(executor, changes, &update);
  else if (!enter(executor, changes, &update))
    place_here(executor, {}, &update);
  Stopwatch watch;
  textures_.emplace(*scene_);
  if (changes.everything) environment_.emplace(executor, scene_->environment);
  update.place_ms += watch.lap_ms();
  pending_ = {};
  return update;
}

void ShownScene::place_here(const Executor& executor, const SceneChanges& changes,
                            UpdateStatistics* update) {
  Stopwatch watch;
  SceneChanges all = std::exchange(behind_, {});
  all.add(changes);
  unbound_ = {};
  update->rebound_meshes = update_bounds(executor, *scene_, all, &object_bounds_);
  update->bound_ms = watch.lap_ms();
  const FlatUpdate placed = update_flat(executor, *scene_, all, object_bounds_, &flat_);
  update->placed_triangles = placed.placed_triangles;
  cache_.update(executor, flat_, placed);
  update->place_ms = watch.lap_ms();
}

bool ShownScene::enter(const Executor& executor, const SceneChanges& changes,
                       UpdateStatistics* update) {
  Stopwatch watch;
  behind_.add(changes);
  behind_.posed.clear();  // `settle` has moved the vertices
  behind_.move_vertices = {};
  if (entering_ == 0 || !entered_.enter(executor, *scene_, behind_, !changes.empty(), entering_))
    return false;
  cache_.entered = entered_.levels();
  placing_ = "instances: entered by the rays where they stand, because " + entered_.reason();
  update->place_ms = watch.lap_ms();
  return true;
}

void ShownScene::place_there(const Executor& executor, const SceneChanges& changes,
                             UpdateStatistics* update) {
  Stopwatch watch;
  behind_.add(changes);
  const FlatUpdate moved = move_flat_meshes(*scene_, changes, object_bounds_, &flat_);
  if (!moved.placed_meshes.empty() && !move_there(changes, moved.placed_meshes)) {
    move_vertices(behind_);  // the host says which vertex it is
    return place_here(executor, {}, update);
  }
  update->placed_triangles = moved.placed_triangles;
  update->place_ms = watch.lap_ms();
  update->rebound_meshes = bound_there();
  update->bound_ms = watch.lap_ms();
}

bool ShownScene::move_there(const SceneChanges& changes, const std::vector<std::uint32_t>& places) {
  const std::optional<Box> bounds =
      cache_.stages->place(flat_, places, View<const MeshPose>(changes.posed));
  if (!bounds) return false;
  flat_.bounds = *bounds;
  cache_.forget_places();
  SceneChanges shapes;
  shapes.deformed = changes.deformed;
  unbound_.add(shapes);
  placing_ = "device: places " + counted(places.size(), "instance") + ", by a matrix each";
  if (!changes.posed.empty())
    placing_ += "; moves the vertices of " + counted(changes.posed.size(), "mesh", "es") +
                ", by weights and joints";
  return true;
}

std::uint64_t ShownScene::bound_there() {
  if (!by_spheres_ || unbound_.empty()) return 0;
  const std::vector<std::uint32_t>& meshes = unbound_.deformed;
  const std::vector<Sphere> spheres =
      cache_.stages->shape_bounds(flat_, View<const std::uint32_t>(meshes));
  for (std::size_t i = 0; i < meshes.size(); ++i) object_bounds_[meshes[i]] = spheres[i];
  static_cast<void>(move_flat_meshes(*scene_, unbound_, object_bounds_, &flat_));
  unbound_ = {};
  if (!placing_.empty()) placing_ += ", and finds their spheres";
  return spheres.size();
}

void ShownScene::catch_up(const Executor& executor) {
  if (behind_.empty()) return;
  const SceneChanges changes = std::exchange(behind_, {});
  unbound_ = {};
  move_vertices(changes);
  update_bounds(executor, *scene_, changes, &object_bounds_);
  static_cast<void>(update_flat(executor, *scene_, changes, object_bounds_, &flat_));
}

UpdateStatistics ShownScene::count_changes(const SceneChanges& changes) const {
  UpdateStatistics update;
  update.moved_instances = changes.moved.size();
  update.deformed_meshes = changes.deformed.size();
  const std::size_t meshes = scene_->meshes.size();
  const std::size_t other =
      changes.everything ? 0 : std::min<std::size_t>(changes.other_meshes_from, meshes);
  update.replaced_meshes = meshes - other;
  return update;
}

}  // namespace raysheaf
