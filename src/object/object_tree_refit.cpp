#include <array>
#include <atomic>

#include "base/bits.h"
#include "base/vec.h"
#include "object/object_tree.h"
#include "object/tree_emission.h"
#include "object/tree_kernels.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

constexpr std::size_t kGrain = 1024;

bool gained_area(const Executor& executor, const TriangleSource& source,
                 const std::vector<std::uint32_t>& left_out) {
  std::atomic<bool> gained{false};
  executor.for_each(left_out.size(), kGrain, [&](std::size_t i) {
    const TriangleRun& run = source.runs[source.run_of(left_out[i])];
    const std::array<Vec3, 3> c = run.corners(left_out[i] - run.first);
    if (!has_no_area(c[0], c[1], c[2])) gained.store(true, std::memory_order_relaxed);
  });
  return gained;
}

/// New boxes for the children of the nodes [begin, end), from the last up; returns the sum of
/// `cost_below`.
double refit_nodes(std::uint32_t begin, std::uint32_t end, const ObjectTree& tree) {
  double cost = 0;
  for (std::uint32_t n = end; n-- > begin;) {
    BvhNode& node = tree.nodes[n];
    for (std::uint32_t c = 0; c < node.children; ++c) {
      Box box;
      if (node.is_leaf(c)) {
        quad_box(tree.quads[node.first[c]], &box);
      } else {
        node_box(tree.nodes[node.first[c]], &box);
      }
      for (int axis = 0; axis < 3; ++axis) {
        node.bound[axis][c] = component(box.min, axis);
        node.bound[3 + axis][c] = component(box.max, axis);
      }
    }
    cost += cost_below(node);
  }
  return cost;
}

}  // namespace

bool refit_object_tree(const Executor& executor, const TriangleSource& source, ObjectTree* tree) {
  if (gained_area(executor, source, tree->left_out)) return false;
  if (tree->empty()) return true;
  executor.for_each_block(tree->quads.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    refill_quads(source, static_cast<std::uint32_t>(end - begin), tree->quads.data() + begin);
  });
  const std::vector<std::uint32_t>& starts = tree->region_starts;
  std::vector<double> costs(starts.size() - 1);
  executor.for_each(costs.size() - 1, 1, [&](std::size_t r) {
    costs[r + 1] = refit_nodes(starts[r + 1], starts[r + 2], *tree);
  });
  costs[0] = refit_nodes(starts[0], starts[1], *tree);
  double below = 0;
  for (const double cost : costs) below += cost;
  finish_tree(below, tree);
  return true;
}

}  // namespace raysheaf
