#include <array>

#include "base/bits.h"
#include "object/object_tree.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

/// The triangles that have an area, as `build_bvh` wants them.
struct Solid {
  std::vector<float> vertex[3][3];
  std::vector<std::uint32_t> ids;

  [[nodiscard]] TriangleView view() const {
    TriangleView v;
    v.count = static_cast<std::uint32_t>(ids.size());
    for (int k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) v.vertex[k][axis] = vertex[k][axis].data();
    return v;
  }
};

Solid solid_triangles(const TriangleSource& source, std::vector<std::uint32_t>* left_out) {
  Solid solid;
  source.for_each_part(
      0, source.count, [&](const TriangleRun& run, std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
          const std::array<Vec3, 3> c = run.corners(i);
          if (has_no_area(c[0], c[1], c[2])) {
            left_out->push_back(run.first + i);
            continue;
          }
          solid.ids.push_back(run.first + i);
          for (int k = 0; k < 3; ++k)
            for (int axis = 0; axis < 3; ++axis)
              solid.vertex[k][axis].push_back(component(c[static_cast<std::size_t>(k)], axis));
        }
      });
  return solid;
}

}  // namespace

void build_fine_object_tree(const Executor& executor, const TriangleSource& source,
                            ObjectTree* tree) {
  tree->left_out.clear();
  const Solid solid = solid_triangles(source, &tree->left_out);
  const Bvh bvh = build_bvh(executor, solid.view());
  tree->triangles = static_cast<std::uint32_t>(solid.ids.size());
  tree->nodes.resize_uninitialized(bvh.nodes.size());
  std::uint32_t quads = 0;
  for (std::size_t n = 0; n < bvh.nodes.size(); ++n) {
    BvhNode& node = tree->nodes[n] = bvh.nodes[n];
    for (std::uint32_t c = 0; c < kBvhWidth; ++c) {
      if (c >= node.children) node.first[c] = node.count[c] = 0;
      if (node.count[c] != 0) quads += div_ceil(node.count[c], 4);
    }
  }
  tree->quads.resize_uninitialized(quads);
  quads = 0;
  for (BvhNode& node : tree->nodes) {
    for (std::uint32_t c = 0; c < node.children; ++c) {
      if (node.count[c] == 0) continue;
      const std::uint32_t first = node.first[c], blocks = div_ceil(node.count[c], 4);
      for (std::uint32_t lane = 0; lane < 4 * blocks; ++lane) {
        const std::uint32_t i = lane < node.count[c] ? lane : 0;
        tree->quads[quads + lane / 4].id[lane % 4] = solid.ids[bvh.triangles[first + i]];
      }
      node.first[c] = quads;
      quads += blocks;
    }
  }
  static_cast<void>(refit_object_tree(executor, source, tree));
}

void build_object_tree(const Executor& executor, const TriangleSource& source, ObjectTree* tree) {
  build_fine_object_tree(executor, source, tree);
}

}  // namespace raysheaf
