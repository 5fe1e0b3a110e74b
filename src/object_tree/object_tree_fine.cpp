#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "base/bits.h"
#include "base/vec.h"
#include "object_tree/fine_build.h"
#include "object_tree/object_tree.h"
#include "object_tree/tree_emission.h"
#include "object_tree/triangle_reader.h"

namespace raysheaf {
namespace {

std::vector<AreaItem> items_of(const TriangleSource& source, View<const std::uint32_t> numbers) {
  std::vector<AreaItem> items;
  items.reserve(numbers.size);
  for (const std::uint32_t number : numbers) {
    const TriangleRun& run = source.runs[source.run_of(number)];
    const std::array<Vec3, 3> c = run.corners(number - run.first);
    items.push_back({min(min(c[0], c[1]), c[2]), number, max(max(c[0], c[1]), c[2]), 1});
  }
  return items;
}

AreaItem item_of(const TriangleQuad& quad, std::uint32_t lane) {
  Box box;
  for (const auto& corner : quad.vertex) {
    const Vec3 p{corner[0][lane], corner[1][lane], corner[2][lane]};
    box = {min(box.min, p), max(box.max, p)};
  }
  return {box.min, quad.id[lane], box.max, 1};
}

/// Calls `body(child, box)` for each child of nodes that is a run of items.
template <class Body>
void for_each_leaf(std::vector<AreaNode>& nodes, const Body& body) {
  for (AreaNode& node : nodes)
    for (std::uint32_t c = 0; c < node.children; ++c)
      if (node.child[c].kind == AreaChild::kItems) body(node.child[c], node.box[c]);
}

/// Gives each leaf of `area` a quad with the numbers of its triangles, and emits the nodes. Corners
/// are left to the caller.
void emit_tree(const Executor& executor, AreaTree& area, View<const AreaItem> items,
               ObjectTree* tree) {
  const auto nodes_of = [&](std::size_t r) -> std::vector<AreaNode>& {
    return r == 0 ? area.top : area.parts[r - 1].nodes;
  };
  std::vector<std::uint32_t> first(area.part_count + 2);
  executor.for_each(first.size() - 1, 1, [&](std::size_t r) {
    for_each_leaf(nodes_of(r), [&](const AreaChild&, const Box&) { ++first[r + 1]; });
  });
  for (std::size_t r = 1; r < first.size(); ++r) first[r] += first[r - 1];
  TreeScratch& scratch = tree->scratch;
  tree->quads.resize_uninitialized(first.back());
  scratch.leaves.resize_uninitialized(first.back());
  scratch.clusters.resize_uninitialized(first.back());
  executor.for_each(first.size() - 1, 1, [&](std::size_t r) {
    std::uint32_t leaf = first[r];
    for_each_leaf(nodes_of(r), [&](AreaChild& child, const Box& box) {
      for (std::uint32_t lane = 0; lane < kQuadTriangles; ++lane)
        tree->quads[leaf].id[lane] = items[child.first + (lane < child.count ? lane : 0)].ref;
      scratch.leaves[leaf] = {box.min, leaf, box.max, child.count};
      scratch.clusters[leaf] = {box.min, leaf, box.max, 1};
      child.first = leaf++;
    });
  });
  emit_nodes(executor, area, {scratch.clusters.data(), scratch.clusters.size()},
             {scratch.leaves.data(), scratch.leaves.size()}, tree);
}

}  // namespace

void FineBuild::begin(const ObjectTree& tree) {
  abandon();
  items_.resize_uninitialized(tree.triangles);
  area_ = std::make_unique<AreaTree>();
}

std::uint32_t FineBuild::gather(const Executor& executor, const ObjectTree& tree,
                                std::uint64_t visits) {
  constexpr std::uint32_t kBlockNodes = 64, kBlockVisits = kBlockNodes * kBvhWidth * 4;
  const auto nodes = static_cast<std::uint32_t>(tree.nodes.size());
  const auto blocks = static_cast<std::uint32_t>(
      std::min<std::uint64_t>(div_ceil(nodes - next_node_, kBlockNodes), visits / kBlockVisits));
  const auto for_each_node = [&](std::size_t block, const auto& body) {
    const std::uint32_t begin = next_node_ + static_cast<std::uint32_t>(block) * kBlockNodes;
    for (std::uint32_t n = begin; n < std::min(nodes, begin + kBlockNodes); ++n)
      body(tree.nodes[n]);
  };
  std::vector<std::uint32_t> first(blocks + 1);
  executor.for_each(blocks, 1, [&](std::size_t b) {
    for_each_node(b, [&](const BvhNode& node) {
      for (const std::uint8_t count : node.count) first[b + 1] += count;
    });
  });
  first[0] = gathered_;
  for (std::uint32_t b = 0; b < blocks; ++b) first[b + 1] += first[b];
  executor.for_each(blocks, 1, [&](std::size_t b) {
    AreaItem* item = items_.data() + first[b];
    for_each_node(b, [&](const BvhNode& node) {
      for (std::uint32_t c = 0; c < node.children; ++c)
        for (std::uint32_t i = 0; i < node.count[c]; ++i)
          *item++ = item_of(tree.quads[node.first[c] + i / kQuadTriangles], i % kQuadTriangles);
    });
  });
  next_node_ = std::min(nodes, next_node_ + blocks * kBlockNodes);
  const std::uint32_t count = first[blocks] - gathered_;
  gathered_ = first[blocks];
  if (next_node_ == nodes) {
    constexpr AreaOptions kFine{kQuadTriangles, true, true, 8192};
    builder_.emplace(View<AreaItem>(items_.data(), items_.size()), kFine, area_.get());
  }
  return count;
}

double FineBuild::advance(const Executor& executor, const ObjectTree& tree, double ns) {
  constexpr double kVisit = 8, kMostVisits = 1e15;
  const auto visits = static_cast<std::uint64_t>(std::min(ns / kVisit, kMostVisits));
  std::uint64_t done = 0;
  if (!builder_.has_value()) done = gather(executor, tree, visits);
  if (builder_.has_value() && done < visits) done += builder_->advance(executor, visits - done);
  return kVisit * static_cast<double>(done);
}

bool FineBuild::finish(const Executor& executor, const TriangleSource& source, ObjectTree* tree) {
  const FineBuild built = std::exchange(*this, {});
  emit_tree(executor, *built.area_, {built.items_.data(), built.items_.size()}, tree);
  return refit_object_tree(executor, source, MovedTriangles::everything(), tree);
}

std::size_t FineBuild::memory_bytes() const {
  return items_.capacity_bytes() + (area_ != nullptr ? area_->memory_bytes() : 0) +
         (builder_.has_value() ? builder_->memory_bytes() : 0);
}

void build_fine_object_tree(const Executor& executor, const TriangleSource& source,
                            ObjectTree* tree) {
  build_object_tree(executor, source, tree);
  if (tree->empty()) return;
  FineBuild build;
  build.begin(*tree);
  build.advance(executor, *tree, std::numeric_limits<double>::infinity());
  static_cast<void>(build.finish(executor, source, tree));
  tree->scratch = {};
}

void build_object_tree_of(const Executor& executor, const TriangleSource& source,
                          View<const std::uint32_t> numbers, ObjectTree* tree) {
  tree->left_out.clear();
  std::vector<AreaItem> items = items_of(source, numbers);
  tree->triangles = static_cast<std::uint32_t>(items.size());
  AreaTree area;
  build_area_tree(executor, items, {kQuadTriangles, true, true}, &area);
  emit_tree(executor, area, items, tree);
  executor.for_each_block(tree->quads.size(), kWorkGrain, [&](std::size_t begin, std::size_t end) {
    TriangleReader reader(source);
    for (std::size_t q = begin; q < end; ++q) {
      TriangleQuad& quad = tree->quads[q];
      LoadedTriangle t[kQuadTriangles];
      for (std::uint32_t i = 0; i < kQuadTriangles; ++i)
        t[i] = load_corners(reader.corners(quad.id[i]));
      store_quad(t, &quad);
    }
  });
  tree->scratch = {};  // the next rebuild is far away
}

}  // namespace raysheaf
