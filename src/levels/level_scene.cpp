#include "levels/level_scene.h"

#include "object_tree/area_tree.h"
#include "object_tree/tree_emission.h"

namespace raysheaf {
namespace {

/// The box of an instance, from those of the root's children, which fit a turned mesh better than
/// its box.
Box world_box(const LevelInstance& instance) {
  const BvhNode& root = instance.tree->nodes[0];
  Box box;
  for (std::uint32_t c = 0; c < root.children; ++c) {
    const Box one = placed_box(instance.placing, root.box(c));
    box.min = min(box.min, one.min);
    box.max = max(box.max, one.max);
  }
  return box;
}

/// Fills `leaves`, by instance.
void find_boxes(const Executor& executor, View<const LevelInstance> instances,
                Buffer<AreaItem>* leaves) {
  leaves->resize_uninitialized(instances.size);
  executor.for_each(instances.size, kWorkGrain, [&](std::size_t i) {
    const Box box = world_box(instances[i]);
    (*leaves)[i] = {box.min, static_cast<std::uint32_t>(i), box.max, 1};
  });
}

/// The box of all children.
Box box_of(const BvhNode& node) {
  Box box;
  for (std::uint32_t c = 0; c < node.children; ++c) {
    const Box one = node.box(c);
    box.min = min(box.min, one.min);
    box.max = max(box.max, one.max);
  }
  return box;
}

}  // namespace

void build_mesh_tree(const Executor& executor, const TriangleSource& source, ObjectTree* tree) {
  TreeOptions options;
  options.keep_flat = options.keep_corners = true;
  build_object_tree(executor, source, tree, options);
  tree->scratch = {};
}

void build_top_tree(const Executor& executor, View<const LevelInstance> instances,
                    ObjectTree* top) {
  TreeScratch& scratch = top->scratch;
  find_boxes(executor, instances, &scratch.leaves);
  const View<const AreaItem> leaves(scratch.leaves);
  scratch.clusters.resize_uninitialized(leaves.size);
  for (std::uint32_t i = 0; i < leaves.size; ++i)
    scratch.clusters[i] = {leaves[i].min, i, leaves[i].max, 1};
  build_area_tree(executor, {scratch.clusters.data(), leaves.size}, {}, &scratch.upper);
  emit_nodes(executor, scratch.upper, {scratch.clusters.data(), leaves.size}, leaves, top);
}

void refit_top_tree(const Executor& executor, View<const LevelInstance> instances,
                    ObjectTree* top) {
  find_boxes(executor, instances, &top->scratch.leaves);
  double cost = 0;
  for (std::size_t n = top->nodes.size(); n-- > 0;) {  // children follow their parents
    BvhNode& node = top->nodes[n];
    for (std::uint32_t c = 0; c < node.children; ++c) {
      const AreaItem* const leaf = node.is_leaf(c) ? &top->scratch.leaves[node.first[c]] : nullptr;
      node.set_box(c,
                   leaf != nullptr ? Box{leaf->min, leaf->max} : box_of(top->nodes[node.first[c]]));
    }
    cost += cost_below(node);
  }
  finish_tree(cost, top);
}

}  // namespace raysheaf
