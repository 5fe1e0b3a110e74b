#include <algorithm>

#include "base/bits.h"
#include "paper/ray_hierarchy/hierarchy.h"

namespace raysheaf {
namespace {

constexpr std::size_t kNodeGrain = 256;

/// Builds the nodes of a level from the items below it.
template <class Bound, class Item, class Make>
std::vector<Bound> build_level(const Executor& executor, View<const Item> below,
                               std::uint32_t branching, const Make& make) {
  std::vector<Bound> nodes(div_ceil(below.size, branching));
  executor.for_each(nodes.size(), kNodeGrain, [&](std::size_t i) {
    const std::size_t first = i * branching;
    make(below.slice(first, std::min<std::size_t>(branching, below.size - first)), &nodes[i]);
  });
  return nodes;
}

}  // namespace

template <class Bound>
RayHierarchy<Bound> build_hierarchy(const Executor& executor, View<const Ray> rays,
                                    const Box& scene, std::uint32_t branching,
                                    std::uint32_t levels) {
  RayHierarchy<Bound> tree;
  tree.branching = branching;
  tree.ray_count = static_cast<std::uint32_t>(rays.size);
  tree.levels.push_back(build_level<Bound>(
      executor, rays, branching,
      [&](View<const Ray> below, Bound* bound) { bound_rays(below, scene, bound); }));
  while (tree.top() < levels) {
    tree.levels.push_back(build_level<Bound>(
        executor, View<const Bound>(tree.levels.back()), branching,
        [](View<const Bound> below, Bound* bound) { bound_children(below, bound); }));
  }
  return tree;
}

#define RAYSHEAF_BUILD(Bound)                                                           \
  template RayHierarchy<Bound> build_hierarchy<Bound>(const Executor&, View<const Ray>, \
                                                      const Box&, std::uint32_t, std::uint32_t)
RAYSHEAF_BUILD(RayBound);
RAYSHEAF_BUILD(FiniteCone);
RAYSHEAF_BUILD(Shaft);
RAYSHEAF_BUILD(Frustum);
RAYSHEAF_BUILD(ShaftCone);
#undef RAYSHEAF_BUILD

}  // namespace raysheaf
