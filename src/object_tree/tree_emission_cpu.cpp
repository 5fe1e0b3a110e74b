#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#include "base/bits.h"
#include "base/vec.h"
#include "object_tree/tree_emission.h"
#include "object_tree/tree_kernels.h"

namespace raysheaf {
namespace {

void set_leaf(BvhNode* node, std::uint32_t c, View<const AreaItem> leaves, std::uint32_t leaf) {
  node->set_box(c, {leaves[leaf].min, leaves[leaf].max});
  node->first[c] = leaves[leaf].ref;
  node->count[c] = static_cast<std::uint8_t>(leaves[leaf].weight);
}

void clear_unused(BvhNode* node) {
  for (std::uint32_t c = node->children; c < kBvhWidth; ++c) {
    node->set_box(c, {});
    node->first[c] = 0;
    node->count[c] = 0;
  }
}

/// Chooses the clusters, from the widest on, whose leaves fit into the node itself: bit c of `mark`
/// for child c. Returns how many clusters do not.
std::uint32_t place_clusters(View<const AreaItem> clusters, AreaNode* node) {
  std::uint32_t open = 0, children = 0, all = 0;
  const auto weight = [&](std::uint32_t c) { return clusters[node->child[c].first].weight; };
  for (std::uint32_t c = 0; c < node->children; ++c) {
    const bool is_cluster = node->child[c].kind == AreaChild::kItems;
    children += is_cluster && weight(c) != 1 ? 0 : 1;
    all += is_cluster ? weight(c) : 1;
    if (is_cluster) open |= 1u << c;
  }
  node->mark = open;
  if (all <= kBvhWidth) return 0;
  std::array<double, kBvhWidth> area{};
  for (std::uint32_t c = 0; c < node->children; ++c) {
    if ((open >> c & 1) == 0) continue;
    if (weight(c) == 1) open &= ~(1u << c);
    area[c] = half_area(node->box[c]);
  }
  children += static_cast<std::uint32_t>(std::popcount(open));
  std::uint32_t left = 0;
  while (open != 0) {
    std::uint32_t widest = static_cast<std::uint32_t>(std::countr_zero(open));
    for (std::uint32_t c = widest + 1; c < node->children; ++c)
      if ((open >> c & 1) != 0 && area[c] > area[widest]) widest = c;
    assert(widest < node->children);
    open &= ~(1u << widest);
    if (children + weight(widest) - 1 <= kBvhWidth) {
      children += weight(widest) - 1;
    } else {
      node->mark &= ~(1u << widest);
      ++left;
    }
  }
  return left;
}

/// One region: the nodes of a part or of the top, followed by those of clusters.
class Region {
 public:
  Region(std::vector<AreaNode>& from, View<const AreaItem> clusters, View<const AreaItem> leaves)
      : from_(from), clusters_(clusters), leaves_(leaves) {}

  /// Decides which clusters have nodes; returns the total number of nodes.
  [[nodiscard]] std::uint32_t plan() const {
    auto count = static_cast<std::uint32_t>(from_.size());
    for (AreaNode& node : from_) count += place_clusters(clusters_, &node);
    return count;
  }

  /// Returns the sum of `cost_below`.
  double write(std::uint32_t first, const std::vector<std::uint32_t>& part_starts, BvhNode* nodes) {
    std::uint32_t next = first + static_cast<std::uint32_t>(from_.size());
    double cost = 0;
    for (std::uint32_t n = 0; n < from_.size(); ++n) {
      const AreaNode& from = from_[n];
      BvhNode* node = &nodes[first + n];
      node->children = 0;
      for (std::uint32_t c = 0; c < from.children; ++c) {
        const AreaChild& child = from.child[c];
        if (child.kind == AreaChild::kItems && (from.mark >> c & 1) != 0) {
          write_leaves_of(clusters_[child.first], node);
          continue;
        }
        const std::uint32_t place = node->children++;
        node->set_box(place, from.box[c]);
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

  std::vector<AreaNode>& from_;
  View<const AreaItem> clusters_, leaves_;
};

}  // namespace

double half_area(const Box& box) {
  const double x = double{box.max.x} - box.min.x, y = double{box.max.y} - box.min.y,
               z = double{box.max.z} - box.min.z;
  return x * y + y * z + z * x;
}

double cost_below(const BvhNode& node) {
  std::array<double, kBvhWidth> cost;
  for (std::uint32_t c = 0; c < kBvhWidth; ++c) {
    const double x = double{node.bound[3][c]} - node.bound[0][c];
    const double y = double{node.bound[4][c]} - node.bound[1][c];
    const double z = double{node.bound[5][c]} - node.bound[2][c];
    const double tests = std::max(1u, div_ceil(std::uint32_t{node.count[c]}, kQuadTriangles));
    cost[c] = c < node.children ? tests * (x * y + y * z + z * x) : 0;
  }
  double sum = 0;
  for (const double each : cost) sum += each;
  return sum;
}

void finish_tree(double below, ObjectTree* tree) {
  tree->bounds = {};
  tree->surface_area_cost = 0;
  if (tree->empty()) return;
  node_box(tree->nodes[0], &tree->bounds);
  const double area = half_area(tree->bounds);
  if (area > 0) tree->surface_area_cost = static_cast<float>(1 + below / area);
}

NodeEmission::NodeEmission(AreaTree& upper, View<const AreaItem> clusters,
                           View<const AreaItem> leaves, ObjectTree* tree)
    : upper_(upper),
      clusters_(clusters),
      leaves_(leaves),
      tree_(*tree),
      costs_(upper.part_count + 1) {
  tree_.region_starts.assign(region_count() + 1, 0);
}

std::vector<AreaNode>& NodeEmission::nodes_of(std::size_t region) const {
  return region == 0 ? upper_.top : upper_.parts[region - 1].nodes;
}

void NodeEmission::count(std::size_t region) {
  tree_.region_starts[region + 1] = Region(nodes_of(region), clusters_, leaves_).plan();
}

void NodeEmission::place() {
  std::vector<std::uint32_t>& starts = tree_.region_starts;
  for (std::size_t r = 0; r < region_count(); ++r) starts[r + 1] += starts[r];
  tree_.nodes.resize_uninitialized(starts.back());
}

void NodeEmission::write(std::size_t region) {
  costs_[region] = Region(nodes_of(region), clusters_, leaves_)
                       .write(tree_.region_starts[region], tree_.region_starts, tree_.nodes.data());
}

void NodeEmission::finish() {
  double below = 0;
  for (const double cost : costs_) below += cost;
  finish_tree(below, &tree_);
}

void emit_nodes(const Executor& executor, AreaTree& upper, View<const AreaItem> clusters,
                View<const AreaItem> leaves, ObjectTree* tree) {
  NodeEmission nodes(upper, clusters, leaves, tree);
  executor.for_each(nodes.region_count(), 1, [&](std::size_t r) { nodes.count(r); });
  nodes.place();
  executor.for_each(nodes.region_count(), 1, [&](std::size_t r) { nodes.write(r); });
  nodes.finish();
}

}  // namespace raysheaf
