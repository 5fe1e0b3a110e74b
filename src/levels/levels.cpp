#include "levels/levels.h"

#include <iterator>
#include <utility>

namespace raysheaf {

std::uint64_t Levels::missing_triangles(View<const PlacedInstance> instances,
                                        View<const std::uint8_t> of) const {
  std::uint64_t missing = 0;
  const PlacedInstance* last = nullptr;
  for (std::size_t i = 0; i < instances.size; ++i) {
    const PlacedInstance& instance = instances[i];
    if ((!of.empty() && of[i] == 0) || (last != nullptr && last->geom_id == instance.geom_id))
      continue;
    last = &instance;
    const auto found = trees_.find(instance.geom_id);
    if (found == trees_.end() || found->second.shape != instance.shape)
      missing += instance.triangle_count;
  }
  return missing;
}

/// Keeps those of meshes that the scene has as they were.
void Levels::forget_old_trees(View<const PlacedInstance> scene) {
  const PlacedInstance* next = scene.begin();
  for (auto tree = trees_.begin(); tree != trees_.end();) {
    while (next != scene.end() && next->geom_id < tree->first) ++next;
    const bool is_there = next != scene.end() && next->geom_id == tree->first;
    tree = is_there && next->shape == tree->second.shape ? std::next(tree) : trees_.erase(tree);
  }
}

/// The trees of the instance's mesh, kept or built.
const Levels::MeshTree& Levels::mesh_of(const Executor& executor, const PlacedInstance& instance) {
  MeshTree& mesh = trees_[instance.geom_id];
  if (mesh.shape != instance.shape) {
    const TriangleRun run = instance.mesh();
    build_mesh_tree(executor, {View<const TriangleRun>(&run, 1), instance.triangle_count},
                    &mesh.tree);
    mesh.moving.reset();
    if (!instance.times.empty()) mesh.moving.emplace(executor, instance, &mesh.tree);
    mesh.shape = instance.shape;
  }
  return mesh;
}

std::uint32_t Levels::update(const Executor& executor, const PlacedRuns& placed,
                             View<const LevelMark> marks, View<const std::uint32_t> members) {
  const View<const PlacedInstance> all = placed.instances();
  const auto one = [&](std::size_t i) -> const PlacedInstance& {
    return all[members.empty() ? i : members[i]];
  };
  forget_old_trees(all);
  for (Above& above : above_)
    above.boxes_are_behind = above.top_is_behind = above.forest_is_behind = true;
  motions_.clear();
  instances_.resize(marks.size);
  worlds_.resize(marks.size);
  const MeshTree* mesh = nullptr;
  for (std::size_t i = 0; i < marks.size; ++i) {
    if (i == 0 || one(i).geom_id != one(i - 1).geom_id) mesh = &mesh_of(executor, one(i));
    instances_[i].tree = &mesh->tree;
    instances_[i].moving = mesh->moving ? &*mesh->moving : nullptr;
    instances_[i].geom_id = one(i).geom_id;
    instances_[i].inst_id = one(i).inst_id;
    instances_[i].mask = marks[i].mask;
    instances_[i].mirrored = one(i).mirrored;
    instances_[i].flags = one(i).flags;
    worlds_[i] = marks[i].world;
    if (one(i).moves()) motions_.resize(marks.size);
  }
  for (std::size_t i = 0; i < motions_.size(); ++i) motions_[i] = one(i).motion;
  executor.for_each(marks.size, kWorkGrain, [&](std::size_t i) {
    instances_[i].placing = make_placing(one(i).to_world, instances_[i].tree->bounds);
  });
  const auto first_without = [this](bool Placing::*what) {
    for (const LevelInstance& instance : instances_)
      if (!(instance.placing.*what)) return instance.inst_id;
    return kInvalidId;
  };
  refuses_rays_ = first_without(&Placing::may_enter);
  return first_without(&Placing::has_boxes);
}

Levels::Above& Levels::above(const Executor& executor, bool in_time) {
  Above& above = above_[in_time ? 1 : 0];
  if (above.boxes_are_behind) {
    above.boxes.resize(instances_.size());
    executor.for_each(instances_.size(), kWorkGrain, [&](std::size_t i) {
      const BoxFit fit = fit_for(instances_.size());
      above.boxes[i] =
          in_time ? world_box(instances_[i], fit, motions_[i]) : world_box(instances_[i], fit);
    });
    above.boxes_are_behind = false;
  }
  return above;
}

void Levels::update_top(const Executor& executor, bool in_time) {
  Above& a = above(executor, in_time && !motions_.empty());
  if (!a.top_is_behind) return;
  const bool is_same = std::exchange(a.top_size, a.boxes.size()) == a.boxes.size();
  a.top.update(executor, View<const Box>(a.boxes), {}, is_same);
  a.top_is_behind = false;
}

void Levels::update_forest(const Executor& executor, bool in_time) {
  Above& a = above(executor, in_time && !motions_.empty());
  if (!a.forest_is_behind) return;
  a.forest.update(executor, View<const Box>(a.boxes), View<const WorldId>(worlds_));
  a.forest_is_behind = false;
}

LevelScene Levels::scene(const float* times) const {
  const bool in_time = times != nullptr && !motions_.empty();
  const Above& a = above_[in_time ? 1 : 0];
  LevelScene scene{View<const LevelInstance>(instances_), a.top_is_behind ? nullptr : &a.top.tree(),
                   a.forest_is_behind ? nullptr : &a.forest};
  if (in_time) scene.times = times, scene.motions = motions_.data();
  return scene;
}

std::size_t Levels::memory_bytes() const {
  std::size_t bytes = instances_.capacity() * sizeof(LevelInstance) +
                      worlds_.capacity() * sizeof(WorldId) +
                      motions_.capacity() * sizeof(View<const Affine>);
  for (const Above& above : above_)
    bytes += above.boxes.capacity() * sizeof(Box) + above.top.tree().memory_bytes() +
             above.forest.memory_bytes();
  for (const auto& [id, mesh] : trees_)
    bytes += sizeof(MeshTree) + mesh.tree.memory_bytes() +
             (mesh.moving ? mesh.moving->memory_bytes() : 0);
  return bytes;
}

}  // namespace raysheaf
