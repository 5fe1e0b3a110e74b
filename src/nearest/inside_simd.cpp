// Compiled once a SIMD target and chosen at run time (Google Highway).
#include <algorithm>
#include <cmath>

#include "geom/rounding.h"
#include "nearest/crossing_body.h"
#include "nearest/inside.h"
#include "nearest/tile_order.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nearest/inside_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// One ray down the tree.
class CrossingWalk {
 public:
  explicit CrossingWalk(const InsideTask& task)
      : tree_(*task.tree), filter_(task.filter), stack_(*task.stack) {}

  /// `number`: of the point among all. Not where the tree is empty.
  Crossings run(const QueryPoint& point, std::uint32_t number, int ray) {
    number_ = number;
    const Point p = point.at;
    const double at[3] = {p.x, p.y, p.z};
    for (int axis = 0; axis < 3; ++axis) {
      up_[axis] = rounded_up(at[axis]);
      down_[axis] = -rounded_up(-at[axis]);
    }
    ray_ = ray;
    // Beyond the point along the axis everything is met, before it nothing.
    (ray < 3 ? up_ : down_)[ray % 3] = ray < 3 ? kInfinity : -kInfinity;
    Crossings sum;
    std::uint32_t top = 0;
    for (std::uint32_t next = 0;;) {
      open(p, tree_.nodes[next], &top, &sum);
      if (top == 0) return sum;
      next = stack_[--top];
    }
  }

 private:
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();

  /// Bits of the lanes whose boxes the ray may meet.
  template <class D, class Low, class High>
  HWY_INLINE std::uint32_t met(D d, const Low& low, const High& high) const {
    const auto along = [&](int axis) HWY_ATTR {
      return hn::And(hn::Le(low(axis), hn::Set(d, up_[axis])),
                     hn::Ge(high(axis), hn::Set(d, down_[axis])));
    };
    return bits_of(d, hn::And(hn::And(along(0), along(1)), along(2)));
  }

  HWY_INLINE void open(Point p, const BvhNode& node, std::uint32_t* top, Crossings* sum) {
    const hn::CappedTag<float, kBvhWidth> d;
    std::uint32_t children = 0;
    for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d))
      children |= met(
                      d, [&](int axis) HWY_ATTR { return hn::Load(d, node.bound[axis] + g); },
                      [&](int axis) HWY_ATTR { return hn::Load(d, node.bound[3 + axis] + g); })
                  << g;
    if (HWY_UNLIKELY(*top + kBvhWidth > stack_.size()))
      stack_.resize(2 * stack_.size() + kBvhWidth);
    for (; children != 0; children &= children - 1) {
      const auto c = static_cast<std::uint32_t>(__builtin_ctz(children));
      if (!node.is_leaf(c)) {
        stack_[(*top)++] = node.first[c];
        continue;
      }
      std::uint32_t left = node.count[c];
      for (std::uint32_t quad = node.first[c];; ++quad, left -= kQuadTriangles) {
        meet(p, tree_.quads[quad], std::min(left, kQuadTriangles), sum);
        if (left <= kQuadTriangles) break;
      }
    }
  }

  HWY_INLINE void meet(Point p, const TriangleQuad& quad, std::uint32_t count, Crossings* sum) {
    const hn::CappedTag<float, kQuadTriangles> d;
    std::uint32_t lanes = 0;
    for (std::size_t g = 0; g < kQuadTriangles; g += hn::Lanes(d)) {
      const auto corner = [&](int k, int axis)
                              HWY_ATTR { return hn::Load(d, quad.vertex[k][axis] + g); };
      lanes |= met(
                   d,
                   [&](int axis) HWY_ATTR {
                     return hn::Min(hn::Min(corner(0, axis), corner(1, axis)), corner(2, axis));
                   },
                   [&](int axis) HWY_ATTR {
                     return hn::Max(hn::Max(corner(0, axis), corner(1, axis)), corner(2, axis));
                   })
               << g;
    }
    for (lanes &= (1u << count) - 1; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(lanes));
      const auto at = [&](int k) {
        return Point{quad.vertex[k][0][lane], quad.vertex[k][1][lane], quad.vertex[k][2][lane]};
      };
      if (filter_ != nullptr && !filter_->shows(number_, quad.id[lane])) continue;
      sum->add(crossing(p, at(0), at(1), at(2), ray_));
    }
  }

  const ObjectTree& tree_;
  const HitFilter* filter_;
  std::vector<std::uint32_t>& stack_;
  std::uint32_t number_ = 0;
  float up_[3] = {}, down_[3] = {};
  int ray_ = 0;
};

/// The ray that leaves the box first, or -1 where the point is outside it.
int shortest_ray(Point p, const Box& box) {
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double x = component(p, axis);
    const double up = (axis == 0 ? box.max.x : axis == 1 ? box.max.y : box.max.z) - x;
    const double down = x - (axis == 0 ? box.min.x : axis == 1 ? box.min.y : box.min.z);
    if (up < 0 || down < 0) return -1;
    if (up < least) least = up, best = axis;
    if (down < least) least = down, best = axis + 3;
  }
  return best;
}

bool is_inside(const InsideTask& task, std::uint32_t i, CrossingWalk* walk) {
  const QueryPoint& point = task.points[i];
  if (task.closed) {
    const int ray = shortest_ray(point.at, task.tree->bounds);
    if (ray < 0) return false;
    const Crossings sum = walk->run(point, task.begin + i, ray);
    return task.rule == InsideRule::kNonZero ? sum.winding != 0 : sum.number % 2 != 0;
  }
  std::int64_t winding = 0, odd = 0;
  for (int ray = 0; ray < kAxisRays; ++ray) {
    const Crossings sum = walk->run(point, task.begin + i, ray);
    winding += sum.winding;
    odd += sum.number % 2;
  }
  return 2 * (task.rule == InsideRule::kNonZero ? std::abs(winding) : odd) > kAxisRays;
}

/// Whether no triangle separates two points, by what is known of how far triangles are.
bool are_together(const QueryPoint& a, const QueryPoint& b, double distance, double slack) {
  const Point step = a.at - b.at;
  return std::sqrt(dot(step, step)) < distance * (1 - 0x1p-30) - slack;
}

void FindInside(const InsideTask& task) {
  if (task.tree->empty()) {
    std::fill_n(task.inside, task.count, std::uint8_t{0});
    return;
  }
  CrossingWalk walk(task);
  const bool is_near = task.closed && task.found != nullptr;
  std::uint32_t before = kMostTilePoints;  // none
  for (std::uint32_t i = 0; i < task.count; ++i) {
    task.executor->check();
    const auto number = static_cast<std::uint32_t>(task.order[i] & (kMostTilePoints - 1));
    const auto distance = [&](std::uint32_t n) {  // beyond a radius nothing is known
      return task.found[n].triangle != kInvalidId ? task.found[n].distance : task.points[n].radius;
    };
    if (is_near && before != kMostTilePoints &&
        are_together(task.points[number], task.points[before],
                     std::max(distance(number), distance(before)), task.slack)) {
      task.inside[number] = task.inside[before];
    } else {
      task.inside[number] = is_inside(task, number, &walk) ? 1 : 0;
    }
    before = number;
  }
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(FindInside);

void find_inside(const InsideTask& task) {
  HWY_DYNAMIC_DISPATCH(FindInside)(task);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
