#include "levels/level_scene.h"

#include "object_tree/area_tree.h"
#include "object_tree/tree_emission.h"
#include "scene/motion.h"

namespace raysheaf {
namespace {

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

BoxFit fit_for(std::size_t instances) {
  constexpr std::size_t kFewInstances = kBvhWidth * kBvhWidth;
  return instances <= kFewInstances ? BoxFit::kQuick : BoxFit::kClose;
}

Box world_box(const LevelInstance& instance, BoxFit fit, View<const Affine> motion, float begin,
              float end) {
  if (motion.empty()) return world_box(instance, fit);
  const Box& bounds = instance.tree->bounds;
  const Vec3 error = mixing_error(motion, max(abs(bounds.min), abs(bounds.max)));
  LevelInstance there = instance;
  Box box;
  for_each_turn(motion, begin, end, [&](const Affine& map) {
    there.placing = make_placing(map, bounds);
    there.placing.box_pad = there.placing.box_pad + error;
    const Box one = world_box(there, fit);
    box = {min(box.min, one.min), max(box.max, one.max)};
  });
  return box;
}

void build_top_tree(const Executor& executor, View<const Box> boxes, ObjectTree* top,
                    View<const std::uint32_t> members) {
  TreeScratch& scratch = top->scratch;
  const std::size_t size = members.empty() ? boxes.size : members.size;
  scratch.leaves.resize_uninitialized(size);
  scratch.clusters.resize_uninitialized(size);
  executor.for_each(size, kWorkGrain, [&](std::size_t i) {
    const auto number = static_cast<std::uint32_t>(i);
    const std::uint32_t instance = members.empty() ? number : members[i];
    const Box& box = boxes[instance];
    scratch.leaves[i] = {box.min, instance, box.max, 1};
    scratch.clusters[i] = {box.min, number, box.max, 1};
  });
  build_area_tree(executor, {scratch.clusters.data(), size}, {}, &scratch.upper);
  emit_nodes(executor, scratch.upper, {scratch.clusters.data(), size},
             {scratch.leaves.data(), size}, top);
}

void refit_top_tree(const Executor& executor, View<const Box> boxes, ObjectTree* top) {
  executor.for_each(top->nodes.size(), kWorkGrain / kBvhWidth, [&](std::size_t n) {
    BvhNode& node = top->nodes[n];
    for (std::uint32_t c = 0; c < node.children; ++c)
      if (node.is_leaf(c)) node.set_box(c, boxes[node.first[c]]);
  });
  double cost = 0;
  for (std::size_t n = top->nodes.size(); n-- > 0;) {  // children follow their parents
    BvhNode& node = top->nodes[n];
    for (std::uint32_t c = 0; c < node.children; ++c)
      if (!node.is_leaf(c)) node.set_box(c, box_of(top->nodes[node.first[c]]));
    cost += cost_below(node);
  }
  finish_tree(cost, top);
}

}  // namespace raysheaf
