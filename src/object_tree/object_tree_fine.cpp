#include <array>

#include "base/bits.h"
#include "base/vec.h"
#include "object_tree/object_tree.h"
#include "object_tree/tree_emission.h"
#include "object_tree/tree_kernels.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

/// The boxes of the triangles that have an area.
std::vector<AreaItem> solid_items(const TriangleSource& source,
                                  std::vector<std::uint32_t>* left_out) {
  std::vector<AreaItem> items;
  items.reserve(source.count);
  source.for_each_part(
      0, source.count, [&](const TriangleRun& run, std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
          const std::array<Vec3, 3> c = run.corners(i);
          if (has_no_area(c[0], c[1], c[2])) {
            left_out->push_back(run.first + i);
            continue;
          }
          items.push_back(
              {min(min(c[0], c[1]), c[2]), run.first + i, max(max(c[0], c[1]), c[2]), 1});
        }
      });
  return items;
}

/// The leaves of a tree over triangles, each a quad. Children that were runs of triangles become
/// clusters of one leaf.
struct Leaves {
  std::vector<std::uint64_t> ids;
  std::vector<std::uint8_t> sizes;
  std::vector<AreaItem> clusters;

  void take(const std::vector<AreaItem>& items, std::vector<AreaNode>* nodes) {
    for (AreaNode& node : *nodes) {
      for (std::uint32_t c = 0; c < node.children; ++c) {
        AreaChild& child = node.child[c];
        if (child.kind != AreaChild::kItems) continue;
        for (std::uint32_t i = 0; i < child.count; ++i) ids.push_back(items[child.first + i].ref);
        child.first = static_cast<std::uint32_t>(sizes.size());
        sizes.push_back(static_cast<std::uint8_t>(child.count));
        clusters.push_back({node.box[c].min, child.first, node.box[c].max, 1});
      }
    }
  }
};

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

void build_over(const Executor& executor, const TriangleSource& source, std::vector<AreaItem> items,
                ObjectTree* tree) {
  tree->triangles = static_cast<std::uint32_t>(items.size());
  AreaTree area;
  build_area_tree(executor, items, {kQuadTriangles, true, true}, &area);
  Leaves leaves;
  leaves.take(items, &area.top);
  for (AreaPart& part : area.parts) leaves.take(items, &part.nodes);
  tree->quads.resize_uninitialized(leaves.sizes.size());
  std::vector<AreaItem> boxes(leaves.sizes.size());
  write_leaves(
      source, nullptr,
      {leaves.ids.data(), 32, leaves.sizes.data(), static_cast<std::uint32_t>(leaves.sizes.size())},
      0, tree->quads.data(), boxes.data());
  emit_nodes(executor, area, leaves.clusters, boxes, tree);
  tree->scratch = {};  // the next rebuild is far away
}

}  // namespace

void build_fine_object_tree(const Executor& executor, const TriangleSource& source,
                            ObjectTree* tree) {
  tree->left_out.clear();
  build_over(executor, source, solid_items(source, &tree->left_out), tree);
}

void build_object_tree_of(const Executor& executor, const TriangleSource& source,
                          View<const std::uint32_t> numbers, ObjectTree* tree) {
  tree->left_out.clear();
  build_over(executor, source, items_of(source, numbers), tree);
}

}  // namespace raysheaf
