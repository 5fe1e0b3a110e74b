#include "levels/levels.h"

#include <utility>

namespace raysheaf {
namespace {

/// A tree over instances that has become this much worse is built again.
constexpr float kMostTopCost = 1.5f;

}  // namespace

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
  // Lost if memory runs out or the caller cancels, so that no half a tree is refitted later.
  ObjectTree top = std::exchange(top_, {});
  const bool same_number = instances_.size() == all.size;
  instances_.assign(all.size, {});
  for (std::size_t i = 0; i < all.size; ++i) {
    const bool is_first = i == 0 || all[i].geom_id != all[i - 1].geom_id;
    instances_[i].tree = is_first ? &tree_of(executor, all[i], &former) : instances_[i - 1].tree;
    instances_[i].geom_id = all[i].geom_id;
    instances_[i].inst_id = all[i].inst_id;
    instances_[i].mask = marks[i].mask;
    instances_[i].world = marks[i].world;
    instances_[i].mirrored = all[i].mirrored;
  }
  executor.for_each(all.size, kWorkGrain, [&](std::size_t i) {
    instances_[i].placing = make_placing(all[i].to_world, instances_[i].tree->bounds);
  });
  for (const LevelInstance& instance : instances_)
    if (!instance.placing.may_enter) return instance.inst_id;
  const View<const LevelInstance> settled(instances_);
  const bool follows = same_number && !top.empty();
  if (follows) refit_top_tree(executor, settled, &top);
  if (!follows || top.surface_area_cost > kMostTopCost * cost_when_built_) {
    build_top_tree(executor, settled, &top);
    cost_when_built_ = top.surface_area_cost;
  }
  top_ = std::move(top);
  return kInvalidId;
}

std::size_t Levels::memory_bytes() const {
  std::size_t bytes = instances_.capacity() * sizeof(LevelInstance) + top_.memory_bytes();
  for (const auto& [id, mesh] : trees_) bytes += sizeof(MeshTree) + mesh.tree.memory_bytes();
  return bytes;
}

}  // namespace raysheaf
