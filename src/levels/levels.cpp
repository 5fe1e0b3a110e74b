#include "levels/levels.h"

#include <utility>

namespace raysheaf {
std::uint64_t Levels::missing_triangles(View<const PlacedInstance> instances) const {
  std::uint64_t missing = 0;
  for (std::size_t i = 0; i < instances.size; ++i) {
    const PlacedInstance& instance = instances[i];
    if (i != 0 && instance.geom_id == instances[i - 1].geom_id) continue;
    const auto found = trees_.find(instance.geom_id);
    if (found == trees_.end() || found->second.shape != instance.shape)
      missing += instance.triangle_count;
  }
  return missing;
}

/// The tree of the instance's mesh, kept or built.
const ObjectTree& Levels::tree_of(const Executor& executor, const PlacedInstance& instance,
                                  std::map<std::uint32_t, MeshTree>* former) {
  if (const auto kept = former->find(instance.geom_id);
      kept != former->end() && kept->second.shape == instance.shape)
    return trees_.insert(former->extract(kept)).position->second.tree;
  MeshTree& mesh = trees_[instance.geom_id];
  const TriangleRun run{instance.positions.data, instance.triangles, 0, instance.triangle_count};
  build_mesh_tree(executor, {View<const TriangleRun>(&run, 1), instance.triangle_count},
                  &mesh.tree);
  mesh.shape = instance.shape;
  return mesh.tree;
}

std::uint32_t Levels::update(const Executor& executor, const PlacedRuns& placed,
                             View<const LevelMark> marks) {
  const View<const PlacedInstance> all = placed.instances();
  std::map<std::uint32_t, MeshTree> former = std::exchange(trees_, {});
  top_is_behind_ = forest_is_behind_ = true;
  instances_.resize(all.size);
  worlds_.resize(all.size);
  for (std::size_t i = 0; i < all.size; ++i) {
    const bool is_first = i == 0 || all[i].geom_id != all[i - 1].geom_id;
    instances_[i].tree = is_first ? &tree_of(executor, all[i], &former) : instances_[i - 1].tree;
    instances_[i].geom_id = all[i].geom_id;
    instances_[i].inst_id = all[i].inst_id;
    instances_[i].mask = marks[i].mask;
    instances_[i].mirrored = all[i].mirrored;
    instances_[i].flags = all[i].flags;
    worlds_[i] = marks[i].world;
  }
  executor.for_each(all.size, kWorkGrain, [&](std::size_t i) {
    instances_[i].placing = make_placing(all[i].to_world, instances_[i].tree->bounds);
  });
  const auto first_without = [this](bool Placing::*what) {
    for (const LevelInstance& instance : instances_)
      if (!(instance.placing.*what)) return instance.inst_id;
    return kInvalidId;
  };
  refuses_rays_ = first_without(&Placing::may_enter);
  return first_without(&Placing::has_boxes);
}

void Levels::update_top(const Executor& executor) {
  if (!top_is_behind_) return;
  const bool is_same = std::exchange(top_size_, instances_.size()) == instances_.size();
  top_.update(executor, View<const LevelInstance>(instances_), {}, is_same);
  top_is_behind_ = false;
}

void Levels::update_forest(const Executor& executor) {
  if (!forest_is_behind_) return;
  forest_.update(executor, View<const LevelInstance>(instances_), View<const WorldId>(worlds_));
  forest_is_behind_ = false;
}

std::size_t Levels::memory_bytes() const {
  std::size_t bytes = instances_.capacity() * sizeof(LevelInstance) +
                      worlds_.capacity() * sizeof(WorldId) + top_.tree().memory_bytes() +
                      forest_.memory_bytes();
  for (const auto& [id, mesh] : trees_) bytes += sizeof(MeshTree) + mesh.tree.memory_bytes();
  return bytes;
}

}  // namespace raysheaf
