#include "paper/packets/bvh.h"

#include "object_tree/area_tree.h"

namespace raysheaf {
namespace {

/// A node of an area tree, and the list that holds it and its children.
struct Place {
  const std::vector<AreaNode>* list;
  std::uint32_t node;
};

/// Writes the nodes of `tree` from the root on, level by level.
void emit(const AreaTree& tree, Bvh* bvh) {
  std::vector<Place> places{{tree.top.empty() ? &tree.parts[0].nodes : &tree.top, 0}};
  std::size_t level_end = 0;
  for (std::size_t n = 0; n < places.size(); ++n) {
    if (n == level_end) {
      ++bvh->depth;
      level_end = places.size();
    }
    const Place place = places[n];
    const AreaNode& from = (*place.list)[place.node];
    BvhNode node{};
    node.children = from.children;
    for (std::uint32_t c = 0; c < from.children; ++c) {
      const AreaChild& child = from.child[c];
      node.set_box(c, from.box[c]);
      if (child.kind == AreaChild::kItems) {
        node.first[c] = child.first;
        node.count[c] = static_cast<std::uint8_t>(child.count);
        ++bvh->leaf_count;
        continue;
      }
      node.first[c] = static_cast<std::uint32_t>(places.size());
      places.push_back(child.kind == AreaChild::kNode ? Place{place.list, child.first}
                                                      : Place{&tree.parts[child.first].nodes, 0});
    }
    bvh->nodes.push_back(node);
  }
}

/// `corner(i, k)`: corner k of triangle i.
template <class Corner>
Bvh build(const Executor& executor, std::size_t count, const Corner& corner) {
  Bvh bvh;
  if (count == 0) return bvh;
  std::vector<AreaItem> items(count);
  executor.for_each(count, kCopyGrain, [&](std::size_t i) {
    const Vec3 a = corner(i, 0), b = corner(i, 1), c = corner(i, 2);
    items[i] = {min(min(a, b), c), static_cast<std::uint32_t>(i), max(max(a, b), c), 1};
  });
  AreaTree tree;
  build_area_tree(executor, items, {kLeafTriangles}, &tree);
  emit(tree, &bvh);
  bvh.triangles.resize(count);
  executor.for_each(count, kCopyGrain, [&](std::size_t i) { bvh.triangles[i] = items[i].ref; });
  return bvh;
}

}  // namespace

Bvh build_bvh(const Executor& executor, const TriangleView& triangles) {
  return build(executor, triangles.count,
               [&](std::size_t i, int k) { return triangles.corner(i, k); });
}

Bvh build_bvh(const Executor& executor, View<const Vec3> corners) {
  return build(executor, corners.size / 3,
               [&](std::size_t i, int k) { return corners[3 * i + static_cast<std::size_t>(k)]; });
}

}  // namespace raysheaf
