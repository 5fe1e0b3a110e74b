#include "levels/level_scene.h"

#include "levels/moving_mesh.h"
#include "levels/refit_boxes.h"
#include "object_tree/area_tree.h"
#include "object_tree/tree_emission.h"
#include "scene/motion.h"

namespace raysheaf {
namespace {

/// Sets the upper two levels of nodes, the root first, to hold a mesh from a time to another.
void hold_steps(const MovingMesh& mesh, float begin, float end, BvhNode (&all)[1 + kBvhWidth]) {
  bool is_first = true;
  const auto unite = [&](const BvhNode& node, BvhNode* hull) {
    if (is_first) *hull = node;
    for (std::uint32_t c = 0; c < node.children; ++c) {
      const Box a = hull->box(c), b = node.box(c);
      hull->set_box(c, {min(a.min, b.min), max(a.max, b.max)});
    }
  };
  mesh.for_each_step(begin, end, [&](const Mix<BvhNode>& nodes) {
    BvhNode room;
    unite(nodes.at(0, &room), &all[0]);
    for (std::uint32_t c = 0; c < all[0].children; ++c)
      if (!all[0].is_leaf(c)) unite(nodes.at(all[0].first[c], &room), &all[1 + c]);
    is_first = false;
  });
  const Vec3 by{mesh.error(), mesh.error(), mesh.error()};
  const auto grow = [&](BvhNode* node) {
    for (std::uint32_t c = 0; c < node->children; ++c)
      node->set_box(c, {node->box(c).min - by, node->box(c).max + by});
  };
  grow(&all[0]);
  for (std::uint32_t c = 0; c < all[0].children; ++c) {
    if (all[0].is_leaf(c)) continue;
    all[0].first[c] = 1 + c;
    grow(&all[1 + c]);
  }
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

Box world_box(const LevelInstance& instance, BoxFit fit) {
  return world_box(instance.placing, instance.tree->nodes.data(), fit);
}

Box world_box(const LevelInstance& instance, BoxFit fit, View<const Affine> motion, float begin,
              float end) {
  const BvhNode* nodes = instance.tree->nodes.data();
  BvhNode held[1 + kBvhWidth];
  if (instance.moving != nullptr) {
    hold_steps(*instance.moving, begin, end, held);
    nodes = held;
  }
  if (motion.empty()) return world_box(instance.placing, nodes, fit);
  const Box& bounds = instance.tree->bounds;
  const Vec3 error = mixing_error(motion, max(abs(bounds.min), abs(bounds.max)));
  Box box;
  for_each_turn(motion, begin, end, [&](const Affine& map) {
    Placing placing = make_placing(map, bounds);
    placing.box_pad = placing.box_pad + error;
    const Box one = world_box(placing, nodes, fit);
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
  const double cost = refit_boxes(
      executor, View<BvhNode>(top->nodes),
      [&](const BvhNode& node, std::uint32_t child) { return boxes[node.first[child]]; });
  finish_tree(cost, top);
}

}  // namespace raysheaf
