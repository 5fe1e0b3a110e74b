#include "stream/ray_tree.h"

#include <algorithm>
#include <limits>

#include "base/bits.h"
#include "hierarchy/hierarchy.h"

namespace raysheaf {
namespace {

constexpr std::uint32_t kBranching = 16;
/// As many levels as leave no more than `kBranching` nodes at the top.
std::uint32_t level_count(std::size_t rays) {
  std::uint32_t levels = 1;
  for (std::size_t nodes = div_ceil(rays, kBranching); nodes > kBranching; ++levels)
    nodes = div_ceil(nodes, kBranching);
  return levels;
}

float squared_gap(const Box& a, const Box& b) {
  const Vec3 gap = max(max(a.min - b.max, b.min - a.max), {0, 0, 0});
  return dot(gap, gap);
}

}  // namespace

// The line's point at a hit's t lies in the box grown by the slack (geom/ray_end.h). Quotients and
// the differences before them are rounded: gamma(4) of the parameters, as there.
bool may_meet(const Ray& ray, const Box& box) {
  const Vec3 lo = box.min - ray.origin, hi = box.max - ray.origin;
  const float pad = kEndSlack * max_component(max(abs(lo), abs(hi))) + kTinySlack;
  float enter = ray.t_min, exit = ray.t_max;
  clip_to_slab(lo.x - pad, hi.x + pad, ray.direction.x, &enter, &exit);
  clip_to_slab(lo.y - pad, hi.y + pad, ray.direction.y, &enter, &exit);
  clip_to_slab(lo.z - pad, hi.z + pad, ray.direction.z, &enter, &exit);
  return enter * (1 - gamma(4)) <= exit * (1 + gamma(4));
}

RayTree::RayTree(const Executor& executor, View<const Ray> rays, const Box& scene)
    : scene_(scene), rays_(rays.size), numbers_(rays.size) {
  RayOrder order;
  order_rays(executor, rays, Sorting::kCurve, &order);
  executor.for_each(rays.size, kWorkGrain, [&](std::size_t i) {
    numbers_[i] = order.rays[i];
    rays_[i] = rays[order.rays[i]];
  });
  build(executor);
}

void RayTree::build(const Executor& executor) {
  levels_.clear();
  if (rays_.empty()) return;
  const RayHierarchy<Shaft> tree =
      build_hierarchy<Shaft>(executor, rays_, scene_, kBranching, level_count(rays_.size()));
  for (const std::vector<Shaft>& shafts : tree.levels) {
    std::vector<BeamTest>& tests = levels_.emplace_back(shafts.size());
    executor.for_each(shafts.size(), kWorkGrain,
                      [&](std::size_t i) { tests[i] = make_node_test(shafts[i]); });
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
  // A node's children replace it, on each of a handful of levels.
  Node stack[kBranching * 9];
  std::size_t top = 0;
  if (levels_.empty()) return;
  const auto level = static_cast<std::uint32_t>(levels_.size() - 1);
  for (auto i = static_cast<std::uint32_t>(levels_.back().size()); i-- > 0;)
    stack[top++] = {level, i};
  while (top > 0) {
    const Node node = stack[--top];
    if (!raysheaf::meets(levels_[node.level][node.index], box)) continue;
    const std::uint32_t first = node.index * kBranching;
    if (node.level == 0) {
      const auto end = std::min(first + kBranching, static_cast<std::uint32_t>(rays_.size()));
      if (!leaf(node.index, first, end)) return;
      continue;
    }
    const auto below = static_cast<std::uint32_t>(levels_[node.level - 1].size());
    for (std::uint32_t i = std::min(first + kBranching, below); i-- > first;)
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
