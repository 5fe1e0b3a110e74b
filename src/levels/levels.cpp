#include "levels/levels.h"

#include <algorithm>
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

bool Levels::update(const Executor& executor, const PlacedRuns& placed,
                    View<const std::uint32_t> masks) {
  const View<const PlacedInstance> all = placed.instances();
  std::map<std::uint32_t, MeshTree> former = std::exchange(trees_, {});
  const bool same_number = instances_.size() == all.size;
  instances_.assign(all.size, {});
  for (std::size_t i = 0; i < all.size; ++i) {
    const PlacedInstance& instance = all[i];
    MeshTree& mesh = trees_[instance.geom_id];
    if (const auto kept = former.find(instance.geom_id);
        kept != former.end() && kept->second.shape == instance.shape)
      mesh = std::move(former.extract(kept).mapped());
    if (mesh.shape != instance.shape) {
      const TriangleRun run{instance.positions.data, instance.triangles, 0,
                            instance.triangle_count};
      build_mesh_tree(executor, {View<const TriangleRun>(&run, 1), instance.triangle_count},
                      &mesh.tree);
      mesh.shape = instance.shape;
    }
    instances_[i].tree = &mesh.tree;
    instances_[i].first = placed.runs()[i].first;
    instances_[i].mask = masks[i];
  }
  executor.for_each(all.size, kWorkGrain, [&](std::size_t i) {
    instances_[i].placing = make_placing(all[i].to_world, instances_[i].tree->bounds);
  });
  if (!std::all_of(instances_.begin(), instances_.end(),
                   [](const LevelInstance& i) { return i.placing.may_enter; }))
    return false;
  const View<const LevelInstance> settled(instances_);
  if (same_number && !top_.empty()) {
    refit_top_tree(executor, settled, &top_);
    if (top_.surface_area_cost <= kMostTopCost * cost_when_built_) return true;
  }
  build_top_tree(executor, settled, &top_);
  cost_when_built_ = top_.surface_area_cost;
  return true;
}

std::size_t Levels::memory_bytes() const {
  std::size_t bytes = instances_.capacity() * sizeof(LevelInstance) + top_.memory_bytes();
  for (const auto& [id, mesh] : trees_) bytes += sizeof(MeshTree) + mesh.tree.memory_bytes();
  return bytes;
}

}  // namespace raysheaf
