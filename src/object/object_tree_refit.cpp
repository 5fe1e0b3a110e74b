#include <array>
#include <limits>

#include "base/bits.h"
#include "object/object_tree.h"
#include "scene/flatten_body.h"

namespace raysheaf {
namespace {

constexpr std::size_t kGrain = 512;

std::array<Vec3, 3> corners_of(const TriangleSource& source, std::uint32_t triangle) {
  const TriangleRun& run = source.runs[source.run_of(triangle)];
  return run.corners(triangle - run.first);
}

void read_quad(const TriangleSource& source, TriangleQuad* quad) {
  for (std::uint32_t lane = 0; lane < 4; ++lane) {
    std::array<Vec3, 3> c = corners_of(source, quad->id[lane]);
    if (has_no_area(c[0], c[1], c[2])) c[1] = c[2] = c[0];
    for (std::size_t k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis) quad->vertex[k][axis][lane] = component(c[k], axis);
  }
}

void grow(Box* box, const Box& other) {
  box->min = min(box->min, other.min);
  box->max = max(box->max, other.max);
}

Box quad_box(const TriangleQuad& quad) {
  Box box;
  for (const auto& corner : quad.vertex)
    for (int lane = 0; lane < 4; ++lane) {
      const Vec3 p{corner[0][lane], corner[1][lane], corner[2][lane]};
      grow(&box, {p, p});
    }
  return box;
}

void set_child_box(BvhNode* node, std::uint32_t c, const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    node->bound[axis][c] = component(box.min, axis);
    node->bound[3 + axis][c] = component(box.max, axis);
  }
}

Box node_box(const BvhNode& node) {
  Box box;
  for (std::uint32_t c = 0; c < node.children; ++c)
    grow(&box, {{node.bound[0][c], node.bound[1][c], node.bound[2][c]},
                {node.bound[3][c], node.bound[4][c], node.bound[5][c]}});
  return box;
}

double half_area(const Box& box) {
  const double x = double{box.max.x} - box.min.x, y = double{box.max.y} - box.min.y,
               z = double{box.max.z} - box.min.z;
  return x * y + y * z + z * x;
}

}  // namespace

bool refit_object_tree(const Executor& executor, const TriangleSource& source, ObjectTree* tree) {
  for (const std::uint32_t triangle : tree->left_out) {
    const std::array<Vec3, 3> c = corners_of(source, triangle);
    if (!has_no_area(c[0], c[1], c[2])) return false;
  }
  executor.for_each(tree->quads.size(), kGrain,
                    [&](std::size_t q) { read_quad(source, &tree->quads[q]); });
  tree->bounds = {};
  tree->surface_area_cost = 0;
  double cost = 0, root_area = 0;
  for (std::size_t n = tree->nodes.size(); n-- > 0;) {
    BvhNode& node = tree->nodes[n];
    for (std::uint32_t c = 0; c < kBvhWidth; ++c) {
      Box box;
      if (c < node.children && node.count[c] == 0) box = node_box(tree->nodes[node.first[c]]);
      if (node.count[c] != 0) {
        const std::uint32_t quads = div_ceil(node.count[c], 4);
        for (std::uint32_t q = 0; q < quads; ++q)
          grow(&box, quad_box(tree->quads[node.first[c] + q]));
        cost += half_area(box) * quads;
      }
      set_child_box(&node, c, box);
    }
    tree->bounds = node_box(node);
    root_area = half_area(tree->bounds);
    cost += root_area;
  }
  if (root_area > 0) tree->surface_area_cost = static_cast<float>(cost / root_area);
  return true;
}

}  // namespace raysheaf
