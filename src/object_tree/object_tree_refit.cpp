#include <algorithm>
#include <array>
#include <atomic>
#include <iterator>

#include "base/bits.h"
#include "base/vec.h"
#include "object_tree/object_tree.h"
#include "object_tree/tree_emission.h"
#include "object_tree/tree_kernels.h"
#include "object_tree/triangle_reader.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

bool gained_area(const Executor& executor, const TriangleSource& source,
                 const MovedTriangles& moved, const std::vector<std::uint32_t>& left_out) {
  std::atomic<bool> gained{false};
  executor.for_each(left_out.size(), kWorkGrain, [&](std::size_t i) {
    if (!moved.all() && !moved.has(left_out[i])) return;
    const TriangleRun& run = source.runs[source.run_of(left_out[i])];
    const std::array<Vec3, 3> c = run.corners(left_out[i] - run.first);
    if (!has_no_area(c[0], c[1], c[2])) gained.store(true, std::memory_order_relaxed);
  });
  return gained;
}

/// Turns triangles without area into points.
void flatten(TriangleQuad* quad) {
  for (int lane = 0; lane < 4; ++lane) {
    Vec3 p[3];
    for (int k = 0; k < 3; ++k)
      p[k] = {quad->vertex[k][0][lane], quad->vertex[k][1][lane], quad->vertex[k][2][lane]};
    if (!has_no_area(p[0], p[1], p[2])) continue;
    for (int k = 1; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis)
        quad->vertex[k][axis][lane] = quad->vertex[0][axis][lane];
  }
  QuadExtents(*quad).store_reach(quad);
}

Box box_of(const TriangleQuad& quad) {
  Box box;
  for (const auto& corner : quad.vertex)
    for (int lane = 0; lane < 4; ++lane) {
      const Vec3 p{corner[0][lane], corner[1][lane], corner[2][lane]};
      box = {min(box.min, p), max(box.max, p)};
    }
  return box;
}

/// Updates the corners and the box of a quad, whose triangle numbers stay.
void refill(TriangleReader* reader, TriangleQuad* quad, AreaItem* leaf) {
  LoadedTriangle t[4];
  for (std::uint32_t i = 0; i < 4; ++i) t[i] = load_corners(reader->corners(quad->id[i]));
  Float4 low = t[0].corner[0], high = low;
  for (const LoadedTriangle& triangle : t)
    for (const Float4 p : triangle.corner) low = min(low, p), high = max(high, p);
  store_quad(t, quad);
  store4(low, &leaf->min.x);
  store4(high, &leaf->max.x);
  if (surely_have_area(*quad)) return;
  flatten(quad);
  const Box box = box_of(*quad);
  leaf->min = box.min;
  leaf->max = box.max;
}

/// Updates those that contain a moved triangle.
void refill_moved(const TriangleSource& source, const MovedTriangles& moved, std::size_t begin,
                  std::size_t end, const ObjectTree& tree) {
  TriangleReader reader(source);
  for (std::size_t q = begin; q < end; ++q) {
    TriangleQuad& quad = tree.quads[q];
    const bool any = std::any_of(std::begin(quad.id), std::end(quad.id),
                                 [&](std::uint32_t id) { return moved.has(id); });
    tree.scratch.moved_quads[q] = any ? 1 : 0;
    if (any) refill(&reader, &quad, &tree.scratch.leaves[q]);
  }
}

/// The places of a leaf's quads.
struct QuadRange {
  std::uint32_t begin, end;
};
QuadRange quads_of(const BvhNode& node, std::uint32_t c) {
  return {node.first[c], node.first[c] + div_ceil(std::uint32_t{node.count[c]}, kQuadTriangles)};
}

bool has_moved(const BvhNode& node, std::uint32_t c, const TreeScratch& scratch) {
  if (!node.is_leaf(c)) return scratch.moved_nodes[node.first[c]] != 0;
  const QuadRange quads = quads_of(node, c);
  return std::any_of(scratch.moved_quads.data() + quads.begin,
                     scratch.moved_quads.data() + quads.end,
                     [](std::uint8_t moved) { return moved != 0; });
}

/// The box of a leaf, some of whose quads may not have moved.
Box leaf_box(const BvhNode& node, std::uint32_t c, bool all, const ObjectTree& tree) {
  const QuadRange quads = quads_of(node, c);
  Box box;
  for (std::uint32_t q = quads.begin; q < quads.end; ++q) {
    const AreaItem& quad = tree.scratch.leaves[q];
    const bool is_known = all || tree.scratch.moved_quads[q] != 0;
    const Box one = is_known ? Box{quad.min, quad.max} : box_of(tree.quads[q]);
    box = {min(box.min, one.min), max(box.max, one.max)};
  }
  return box;
}

/// Updates the boxes of the children of the nodes [begin, end) that have moved, from the last to
/// the first; returns the sum of `cost_below`.
double refit_nodes(std::uint32_t begin, std::uint32_t end, bool all, const ObjectTree& tree) {
  const TreeScratch& scratch = tree.scratch;
  double cost = 0;
  for (std::uint32_t n = end; n-- > begin;) {
    BvhNode& node = tree.nodes[n];
    std::uint8_t moved = 0;
    for (std::uint32_t c = 0; c < node.children; ++c) {
      if (!all && !has_moved(node, c, scratch)) continue;
      moved = 1;
      Box box;
      if (node.is_leaf(c)) {
        box = leaf_box(node, c, all, tree);
      } else {
        node_box(tree.nodes[node.first[c]], &box);
      }
      node.set_box(c, box);
    }
    if (!all) scratch.moved_nodes[n] = moved;
    cost += cost_below(node);
  }
  return cost;
}

}  // namespace

void refill_quads(const TriangleSource& source, std::size_t begin, std::size_t end,
                  const ObjectTree& tree) {
  constexpr std::size_t kIndicesAhead = 10, kCornersAhead = 4;
  TriangleReader reader(source);
  for (std::size_t q = begin; q < end; ++q) {
    if (q + kIndicesAhead < end)
      for (const std::uint32_t id : tree.quads[q + kIndicesAhead].id) reader.prefetch_index(id);
    if (q + kCornersAhead < end)
      for (const std::uint32_t id : tree.quads[q + kCornersAhead].id) reader.prefetch_corners(id);
    refill(&reader, &tree.quads[q], &tree.scratch.leaves[q]);
  }
}

bool refit_object_tree(const Executor& executor, const TriangleSource& source,
                       const MovedTriangles& moved, ObjectTree* tree) {
  if (gained_area(executor, source, moved, tree->left_out)) return false;
  if (tree->empty()) return true;
  const bool all = moved.all();
  tree->scratch.leaves.resize_uninitialized(tree->quads.size());
  if (!all) {
    tree->scratch.moved_quads.resize_uninitialized(tree->quads.size());
    tree->scratch.moved_nodes.resize_uninitialized(tree->nodes.size());
  }
  executor.for_each_block(tree->quads.size(), kWorkGrain, [&](std::size_t begin, std::size_t end) {
    if (all) return refill_quads(source, begin, end, *tree);
    refill_moved(source, moved, begin, end, *tree);
  });
  const std::vector<std::uint32_t>& starts = tree->region_starts;
  std::vector<double> costs(starts.size() - 1);
  executor.for_each(costs.size() - 1, 1, [&](std::size_t r) {
    costs[r + 1] = refit_nodes(starts[r + 1], starts[r + 2], all, *tree);
  });
  costs[0] = refit_nodes(starts[0], starts[1], all, *tree);
  double below = 0;
  for (const double cost : costs) below += cost;
  finish_tree(below, tree);
  return true;
}

}  // namespace raysheaf
