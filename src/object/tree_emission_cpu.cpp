#include <algorithm>

#include "base/bits.h"
#include "base/vec.h"
#include "object/tree_emission.h"
#include "object/tree_kernels.h"

namespace raysheaf {
namespace {

void set_box(BvhNode* node, std::uint32_t c, const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    node->bound[axis][c] = component(box.min, axis);
    node->bound[3 + axis][c] = component(box.max, axis);
  }
}

void set_leaf(BvhNode* node, std::uint32_t c, View<const AreaItem> leaves, std::uint32_t leaf) {
  set_box(node, c, {leaves[leaf].min, leaves[leaf].max});
  node->first[c] = leaf;
  node->count[c] = static_cast<std::uint8_t>(leaves[leaf].weight);
}

void clear_unused(BvhNode* node) {
  for (std::uint32_t c = node->children; c < kBvhWidth; ++c) {
    set_box(node, c, {});
    node->first[c] = 0;
    node->count[c] = 0;
  }
}

/// How the clusters below one node are stored: bit c of `inside`, that the leaves of child c are
/// the node's own children.
struct Plan {
  std::uint32_t inside = 0, children = 0, extra_nodes = 0;
};

Plan plan_of(const AreaNode& node, View<const AreaItem> clusters) {
  Plan plan{0, node.children, 0};
  const auto weight = [&](std::uint32_t c) { return clusters[node.child[c].first].weight; };
  std::uint32_t open = 0;
  for (std::uint32_t c = 0; c < node.children; ++c)
    if (node.child[c].kind == AreaChild::kItems) open |= 1u << c;
  for (;;) {
    std::uint32_t widest = kBvhWidth;
    double area = -1;
    for (std::uint32_t c = 0; c < node.children; ++c) {
      if ((open >> c & 1) == 0 || plan.children + weight(c) - 1 > kBvhWidth) continue;
      const double its =
          weight(c) == 1 ? std::numeric_limits<double>::infinity() : half_area(node.box[c]);
      if (its > area) area = its, widest = c;
    }
    if (widest == kBvhWidth) break;
    open &= ~(1u << widest);
    plan.inside |= 1u << widest;
    plan.children += weight(widest) - 1;
  }
  for (; open != 0; open &= open - 1) ++plan.extra_nodes;
  return plan;
}

/// One region: the nodes of a part or of the top, and behind them those of clusters.
class Region {
 public:
  Region(const std::vector<AreaNode>& from, View<const AreaItem> clusters,
         View<const AreaItem> leaves)
      : from_(from), clusters_(clusters), leaves_(leaves) {}

  [[nodiscard]] std::uint32_t node_count() const {
    auto count = static_cast<std::uint32_t>(from_.size());
    for (const AreaNode& node : from_) count += plan_of(node, clusters_).extra_nodes;
    return count;
  }

  /// Returns the sum of `cost_below`.
  double write(std::uint32_t first, const std::vector<std::uint32_t>& part_starts, BvhNode* nodes) {
    std::uint32_t next = first + static_cast<std::uint32_t>(from_.size());
    double cost = 0;
    for (std::uint32_t n = 0; n < from_.size(); ++n) {
      const AreaNode& from = from_[n];
      const Plan plan = plan_of(from, clusters_);
      BvhNode* node = &nodes[first + n];
      node->children = 0;
      for (std::uint32_t c = 0; c < from.children; ++c) {
        const AreaChild& child = from.child[c];
        if (child.kind == AreaChild::kItems && (plan.inside >> c & 1) != 0) {
          write_leaves_of(clusters_[child.first], node);
          continue;
        }
        const std::uint32_t place = node->children++;
        set_box(node, place, from.box[c]);
        node->count[place] = 0;
        node->first[place] = child.kind == AreaChild::kNode   ? first + child.first
                             : child.kind == AreaChild::kPart ? part_starts[child.first + 1]
                                                              : next;
        if (child.kind != AreaChild::kItems) continue;
        nodes[next].children = 0;
        write_leaves_of(clusters_[child.first], &nodes[next]);
        clear_unused(&nodes[next]);
        cost += cost_below(nodes[next++]);
      }
      clear_unused(node);
      cost += cost_below(*node);
    }
    return cost;
  }

 private:
  void write_leaves_of(const AreaItem& cluster, BvhNode* node) const {
    for (std::uint32_t i = 0; i < cluster.weight; ++i)
      set_leaf(node, node->children++, leaves_, cluster.ref + i);
  }

  const std::vector<AreaNode>& from_;
  View<const AreaItem> clusters_, leaves_;
};

}  // namespace

double half_area(const Box& box) {
  const double x = double{box.max.x} - box.min.x, y = double{box.max.y} - box.min.y,
               z = double{box.max.z} - box.min.z;
  return x * y + y * z + z * x;
}

double cost_below(const BvhNode& node) {
  double cost = 0;
  for (std::uint32_t c = 0; c < node.children; ++c) {
    const Box box{{node.bound[0][c], node.bound[1][c], node.bound[2][c]},
                  {node.bound[3][c], node.bound[4][c], node.bound[5][c]}};
    cost += half_area(box) * (node.is_leaf(c) ? div_ceil(node.count[c], kQuadTriangles) : 1);
  }
  return cost;
}

void finish_tree(double below, ObjectTree* tree) {
  tree->bounds = {};
  tree->surface_area_cost = 0;
  if (tree->empty()) return;
  node_box(tree->nodes[0], &tree->bounds);
  const double area = half_area(tree->bounds);
  if (area > 0) tree->surface_area_cost = static_cast<float>(1 + below / area);
}

void emit_nodes(const Executor& executor, const AreaTree& upper, View<const AreaItem> clusters,
                View<const AreaItem> leaves, ObjectTree* tree) {
  const std::size_t regions = upper.part_count + 1;
  const auto region = [&](std::size_t r) {
    return Region(r == 0 ? upper.top : upper.parts[r - 1].nodes, clusters, leaves);
  };
  tree->region_starts.assign(regions + 1, 0);
  executor.for_each(regions, 1,
                    [&](std::size_t r) { tree->region_starts[r + 1] = region(r).node_count(); });
  for (std::size_t r = 0; r < regions; ++r) tree->region_starts[r + 1] += tree->region_starts[r];
  tree->nodes.resize_uninitialized(tree->region_starts.back());
  std::vector<double> costs(regions);
  executor.for_each(regions, 1, [&](std::size_t r) {
    costs[r] = region(r).write(tree->region_starts[r], tree->region_starts, tree->nodes.data());
  });
  double below = 0;
  for (const double cost : costs) below += cost;
  finish_tree(below, tree);
}

}  // namespace raysheaf
