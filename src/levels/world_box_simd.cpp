// Compiled once for each SIMD target and chosen at run time (Google Highway).
#include "levels/level_scene.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "levels/world_box_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"
#include "levels/placed-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The hull of boxes of a tree, where an instance places them.
class PlacedHull {
 public:
  explicit PlacedHull(const Placing& placing) : placing_(placing) {
    for (std::uint32_t c = 0; c < kBvhWidth; ++c) hull_.set_box(c, Box());
  }

  /// `children`: bits of those that belong to it.
  HWY_INLINE void include(const BvhNode& node, std::uint32_t children) {
    BvhNode placed;
    place_node(placing_, node, &placed);
    for (int row = 0; row < 6; ++row) {
      V of = hn::Load(D(), hull_.bound[row]);
      for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(D())) {
        const V one =
            hn::IfThenElse(mask_of(D(), children >> g), hn::Load(D(), placed.bound[row] + g), of);
        of = row < 3 ? hn::Min(of, one) : hn::Max(of, one);
      }
      hn::Store(of, D(), hull_.bound[row]);
    }
  }
  [[nodiscard]] HWY_INLINE Box box() const {
    const auto of = [&](int row) HWY_ATTR {
      const V all = hn::Load(D(), hull_.bound[row]);
      return hn::GetLane(row < 3 ? hn::MinOfLanes(D(), all) : hn::MaxOfLanes(D(), all));
    };
    return {{of(0), of(1), of(2)}, {of(3), of(4), of(5)}};
  }

 private:
  using D = hn::CappedTag<float, kBvhWidth>;
  using V = hn::Vec<D>;

  const Placing& placing_;
  BvhNode hull_;
};

Box WorldBox(const Placing& placing, const BvhNode* nodes, BoxFit fit) {
  const BvhNode& root = nodes[0];
  PlacedHull hull(placing);
  std::uint32_t own = 0;
  for (std::uint32_t c = 0; c < root.children; ++c) {
    if (fit == BoxFit::kQuick || root.is_leaf(c)) {
      own |= 1u << c;
      continue;
    }
    const BvhNode& node = nodes[root.first[c]];
    hull.include(node, (1u << node.children) - 1);
  }
  if (own != 0) hull.include(root, own);
  return hull.box();
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {
namespace {

HWY_EXPORT(WorldBox);

}  // namespace

Box world_box(const Placing& placing, const BvhNode* nodes, BoxFit fit) {
  return HWY_DYNAMIC_DISPATCH(WorldBox)(placing, nodes, fit);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
