#include <algorithm>

#include "base/bits.h"
#include "hierarchy/hierarchy.h"

namespace raysheaf {
namespace {

constexpr std::size_t kNodeGrain = 256;

/// One node of a level from what lies below it.
template <class Item, class Bound>
std::vector<RayBound> build_level(const Executor& executor, View<const Item> below,
                                  std::uint32_t branching, const Bound& bound) {
  std::vector<RayBound> nodes(div_ceil(below.size, branching));
  executor.for_each(nodes.size(), kNodeGrain, [&](std::size_t i) {
    const std::size_t first = i * branching;
    nodes[i] = bound(below.slice(first, std::min<std::size_t>(branching, below.size - first)));
  });
  return nodes;
}

}  // namespace

RayHierarchy build_hierarchy(const Executor& executor, View<const Ray> rays,
                             std::uint32_t branching, std::uint32_t levels) {
  RayHierarchy tree;
  tree.branching = branching;
  tree.ray_count = static_cast<std::uint32_t>(rays.size);
  tree.levels.push_back(build_level(executor, rays, branching,
                                    [](View<const Ray> below) { return bound_rays(below); }));
  while (tree.top() < levels) {
    tree.levels.push_back(
        build_level(executor, View<const RayBound>(tree.levels.back()), branching,
                    [](View<const RayBound> below) { return bound_children(below); }));
  }
  return tree;
}

}  // namespace raysheaf
