// Boxes and triangles of a mesh's tree where an instance stands, in lanes. Included once for each
// SIMD target.
#if defined(RAYSHEAF_LEVELS_PLACED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSHEAF_LEVELS_PLACED_INL_H_
#undef RAYSHEAF_LEVELS_PLACED_INL_H_
#else
#define RAYSHEAF_LEVELS_PLACED_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "object_tree/object_tree.h"
#include "scene/placing.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A component of `transform_point`, operation by operation.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V placed_lanes(D d, const std::array<float, 4>& row, V x, V y, V z) {
  const auto part = [&](int c, V at) HWY_ATTR { return hn::Mul(hn::Set(d, row[c]), at); };
  return hn::Add(hn::Add(hn::Add(part(0, x), part(1, y)), part(2, z)), hn::Set(d, row[3]));
}

/// The boxes of a node's children, as `placed_box` has them; NaN behind the last child.
HWY_INLINE void place_node(const Placing& placing, const BvhNode& node, BvhNode* placed) {
  const hn::CappedTag<float, kBvhWidth> d;
  using V = hn::Vec<decltype(d)>;
  const V half = hn::Set(d, 0.5f);
  for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d)) {
    const auto low = [&](int axis) HWY_ATTR { return hn::Load(d, node.bound[axis] + g); };
    const auto high = [&](int axis) HWY_ATTR { return hn::Load(d, node.bound[3 + axis] + g); };
    const auto middle = [&](int axis)
                            HWY_ATTR { return hn::Mul(hn::Add(low(axis), high(axis)), half); };
    const auto extent = [&](int axis)
                            HWY_ATTR { return hn::Mul(hn::Sub(high(axis), low(axis)), half); };
    const V cx = middle(0), cy = middle(1), cz = middle(2);
    const V ex = extent(0), ey = extent(1), ez = extent(2);
    for (int axis = 0; axis < 3; ++axis) {
      const std::array<float, 4>& m = placing.map.m[axis];
      const V at = placed_lanes(d, m, cx, cy, cz);
      const V by = placed_lanes(
          d, {std::fabs(m[0]), std::fabs(m[1]), std::fabs(m[2]), component(placing.box_pad, axis)},
          ex, ey, ez);
      hn::Store(hn::Sub(at, by), d, placed->bound[axis] + g);
      hn::Store(hn::Add(at, by), d, placed->bound[3 + axis] + g);
    }
  }
  std::copy_n(node.first, kBvhWidth, placed->first);
  std::copy_n(node.count, kBvhWidth, placed->count);
  placed->children = node.children;
}

/// The quad's triangles with the corners of the flat scene; `reach` is not written.
HWY_INLINE void place_quad(const Placing& placing, const TriangleQuad& quad, TriangleQuad* placed) {
  const hn::CappedTag<float, kQuadTriangles> d;
  for (std::size_t g = 0; g < kQuadTriangles; g += hn::Lanes(d))
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](int axis) HWY_ATTR { return hn::Load(d, quad.vertex[k][axis] + g); };
      const auto x = at(0), y = at(1), z = at(2);
      for (int axis = 0; axis < 3; ++axis)
        hn::Store(placed_lanes(d, placing.map.m[axis], x, y, z), d, placed->vertex[k][axis] + g);
    }
  std::copy_n(quad.id, kQuadTriangles, placed->id);
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // RAYSHEAF_LEVELS_PLACED_INL_H_
