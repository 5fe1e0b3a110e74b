#include "out_of_core/ray_tree.h"

#include <algorithm>
#include <limits>

#include "base/bits.h"
#include "exec/radix_sort.h"
#include "rays/ray_place_body.h"

namespace raysheaf {
namespace {

/// A shaft around every `kRayBranching` items: `bound(items, &shaft)`.
template <class Item, class Bound>
std::vector<Shaft> level_over(const Executor& executor, View<const Item> items,
                              const Bound& bound) {
  std::vector<Shaft> shafts(div_ceil(items.size, kRayBranching));
  executor.for_each(shafts.size(), kWorkGrain, [&](std::size_t i) {
    const std::size_t first = i * kRayBranching;
    bound(items.slice(first, std::min<std::size_t>(kRayBranching, items.size - first)), &shafts[i]);
  });
  return shafts;
}

}  // namespace

RayTree::RayTree(const Executor& executor, View<const Ray> rays, const Box& scene)
    : scene_(scene), rays_(rays.size), numbers_(rays.size) {
  std::vector<std::uint64_t> keys(rays.size);
  executor.for_each(rays.size, kWorkGrain, [&](std::size_t i) {
    keys[i] = ray_place(rays[i], scene, kRayKeyAxisBits);
    numbers_[i] = static_cast<std::uint32_t>(i);
  });
  radix_sort_pairs(executor, keys, numbers_, kRayKeyBits);
  executor.for_each(rays.size, kWorkGrain, [&](std::size_t i) { rays_[i] = rays[numbers_[i]]; });
  build(executor);
}

void RayTree::build(const Executor& executor) {
  levels_.clear();
  if (rays_.empty()) return;
  std::vector<Shaft> shafts =
      level_over(executor, View<const Ray>(rays_),
                 [this](View<const Ray> rays, Shaft* shaft) { bound_rays(rays, scene_, shaft); });
  while (true) {
    std::vector<BeamTest>& tests = levels_.emplace_back(shafts.size());
    executor.for_each(shafts.size(), kWorkGrain,
                      [&](std::size_t i) { tests[i] = make_node_test(shafts[i]); });
    if (shafts.size() <= kRayBranching) return;
    shafts = level_over(executor, View<const Shaft>(shafts),
                        [](View<const Shaft> below, Shaft* s) { bound_children(below, s); });
  }
}

void RayTree::refresh(const Executor& executor) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    if (numbers_[i] == kInvalidId) continue;
    rays_[kept] = rays_[i];
    numbers_[kept++] = numbers_[i];
  }
  rays_.resize(kept);
  numbers_.resize(kept);
  build(executor);
}

template <class Leaf>
void RayTree::walk(const Box& box, const Leaf& leaf) const {
  struct Node {
    std::uint32_t level, index;
  };
  // A node is replaced by its children, on each of a few levels.
  Node stack[kRayBranching * 9];
  std::size_t top = 0;
  if (levels_.empty()) return;
  const auto level = static_cast<std::uint32_t>(levels_.size() - 1);
  for (auto i = static_cast<std::uint32_t>(levels_.back().size()); i-- > 0;)
    stack[top++] = {level, i};
  while (top > 0) {
    const Node node = stack[--top];
    if (!raysheaf::meets(levels_[node.level][node.index], box)) continue;
    const std::uint32_t first = node.index * kRayBranching;
    if (node.level == 0) {
      const auto end = std::min(first + kRayBranching, static_cast<std::uint32_t>(rays_.size()));
      if (!leaf(node.index, first, end)) return;
      continue;
    }
    const auto below = static_cast<std::uint32_t>(levels_[node.level - 1].size());
    for (std::uint32_t i = std::min(first + kRayBranching, below); i-- > first;)
      stack[top++] = {node.level - 1, i};
  }
}

bool RayTree::meets(const Box& box) const {
  bool found = false;
  walk(box, [&](std::uint32_t /*node*/, std::uint32_t first, std::uint32_t end) {
    for (std::uint32_t i = first; i < end && !found; ++i) found = may_meet(rays_[i], box);
    return !found;
  });
  return found;
}

float RayTree::squared_distance(const Box& box) const {
  float least = std::numeric_limits<float>::infinity();
  walk(box, [&](std::uint32_t node, std::uint32_t /*first*/, std::uint32_t /*end*/) {
    least = std::min(least, squared_gap(levels_[0][node].origins, box));
    return least > 0;
  });
  return least < std::numeric_limits<float>::infinity() ? least : -1;
}

void RayTree::find(const Box& box, std::vector<std::uint32_t>* places) const {
  places->clear();
  walk(box, [&](std::uint32_t /*node*/, std::uint32_t first, std::uint32_t end) {
    for (std::uint32_t i = first; i < end; ++i) {
      if (may_meet(rays_[i], box)) places->push_back(i);
    }
    return true;
  });
}

}  // namespace raysheaf
