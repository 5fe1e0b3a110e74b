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
#include "levels/placed-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kNoRay = -1;

/// The ray that leaves the box first, or `kNoRay` where the point is outside it.
int shortest_ray(Point p, const Box& box) {
  int best = kNoRay;
  double least = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double x = component(p, axis);
    const double up = (axis == 0 ? box.max.x : axis == 1 ? box.max.y : box.max.z) - x;
    const double down = x - (axis == 0 ? box.min.x : axis == 1 ? box.min.y : box.min.z);
    if (up < 0 || down < 0) return kNoRay;
    if (up < least) least = up, best = axis;
    if (down < least) least = down, best = axis + 3;
  }
  return best;
}

/// Rays from a point through the scene.
class CrossingWalk {
 public:
  explicit CrossingWalk(const InsideTask& task)
      : task_(task), filter_(task.scene->filter), stack_(*task.stack) {}

  /// `number`: of the point among all.
  void set_point(Point p, std::uint32_t number) {
    point_ = p;
    number_ = number;
    const NearestScene& scene = *task_.scene;
    if (scene.levels != nullptr) roots_ = roots_of(*scene.levels, scene.worlds[number]);
    for (int axis = 0; axis < 3; ++axis) {
      above_[axis] = rounded_up(component(p, axis));
      below_[axis] = -rounded_up(-component(p, axis));
    }
  }
  /// Along one ray.
  Crossings along(int ray) {
    sum_ = {};
    aim(ray);
    if (task_.scene->levels != nullptr)
      meet_levels();
    else
      meet_tree(*task_.scene->tree);
    return sum_;
  }
  /// Where all rays agree. Outside of its box a closed surface adds nothing, so only instances are
  /// met whose boxes hold the point, each along a ray that leaves its box first.
  Crossings along_any() {
    const NearestScene& scene = *task_.scene;
    if (scene.levels != nullptr) return along(kNoRay);
    const int ray = shortest_ray(point_, scene.tree->bounds);
    return ray != kNoRay ? along(ray) : Crossings();
  }

 private:
  static constexpr float kInfinity = std::numeric_limits<float>::infinity();

  /// Boxes are met where a ray meets them: beyond the point everything, before it nothing; without
  /// a ray, where they hold the point.
  void aim(int ray) {
    std::copy_n(above_, 3, up_);
    std::copy_n(below_, 3, down_);
    if (ray != kNoRay) (ray < 3 ? up_ : down_)[ray % 3] = ray < 3 ? kInfinity : -kInfinity;
    ray_ = ray;
  }

  void meet_levels() {
    const LevelScene& levels = *task_.scene->levels;
    for (const TopRoot& root : roots_.of) {
      if (root.tree == nullptr) continue;
      walk([&](std::uint32_t n) -> const BvhNode& { return root.tree->nodes[n]; },
           [&](const BvhNode& node, std::uint32_t c) {
             const LevelInstance& instance = levels.instances[node.first[c]];
             if ((instance.mask & task_.scene->mask) == 0) return;
             const bool closed = task_.scene->meshes[node.first[c]].suits(task_.rule);
             const int shortest = closed ? shortest_ray(point_, node.box(c)) : ray_;
             if (shortest == kNoRay) return;
             if (ray_ != kNoRay) return meet_instance(instance);
             aim(shortest);
             meet_instance(instance);
             aim(kNoRay);
           },
           root.node);
    }
  }

  void meet_tree(const ObjectTree& tree) {
    walk([&](std::uint32_t n) -> const BvhNode& { return tree.nodes[n]; },
         [&](const BvhNode& node, std::uint32_t c) {
           for_each_quad(node, c, [&](std::uint32_t quad, std::uint32_t count) {
             meet(tree.quads[quad], count);
           });
         });
  }
  void meet_instance(const LevelInstance& instance) {
    const ObjectTree& tree = *instance.tree;
    if (instance.placing.is_identity) return meet_tree(tree);
    BvhNode placed_node;
    walk(
        [&](std::uint32_t n) -> const BvhNode& {
          place_node(instance.placing, tree.nodes[n], &placed_node);
          return placed_node;
        },
        [&](const BvhNode& node, std::uint32_t c) {
          for_each_quad(node, c, [&](std::uint32_t quad, std::uint32_t count) {
            TriangleQuad placed;
            place_quad(instance.placing, tree.quads[quad], &placed);
            meet(placed, count);
          });
        });
  }

  /// Down the tree whose nodes `node` returns, from `root` on, to `take_leaf(node, child)`.
  template <class Node, class Leaf>
  HWY_INLINE void walk(const Node& node, const Leaf& take_leaf, std::uint32_t root = 0) {
    const std::uint32_t bottom = top_;
    for (std::uint32_t next = root;; next = stack_[--top_]) {
      open(node(next), take_leaf);
      if (top_ == bottom) return;
    }
  }
  template <class Meet>
  HWY_INLINE static void for_each_quad(const BvhNode& node, std::uint32_t child,
                                       const Meet& meet_quad) {
    std::uint32_t left = node.count[child];
    for (std::uint32_t quad = node.first[child];; ++quad, left -= kQuadTriangles) {
      meet_quad(quad, std::min(left, kQuadTriangles));
      if (left <= kQuadTriangles) break;
    }
  }

  /// Bits of the lanes whose boxes the ray may meet.
  template <class D, class Low, class High>
  HWY_INLINE std::uint32_t met(D d, const Low& low, const High& high) const {
    const auto along = [&](int axis) HWY_ATTR {
      return hn::And(hn::Le(low(axis), hn::Set(d, up_[axis])),
                     hn::Ge(high(axis), hn::Set(d, down_[axis])));
    };
    return bits_of(d, hn::And(hn::And(along(0), along(1)), along(2)));
  }

  template <class Leaf>
  HWY_INLINE void open(const BvhNode& node, const Leaf& take_leaf) {
    const hn::CappedTag<float, kBvhWidth> d;
    std::uint32_t children = 0;
    for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d))
      children |= met(
                      d, [&](int axis) HWY_ATTR { return hn::Load(d, node.bound[axis] + g); },
                      [&](int axis) HWY_ATTR { return hn::Load(d, node.bound[3 + axis] + g); })
                  << g;
    if (HWY_UNLIKELY(top_ + kBvhWidth > stack_.size()))
      stack_.resize(2 * stack_.size() + kBvhWidth);
    for (; children != 0; children &= children - 1) {
      const auto c = static_cast<std::uint32_t>(__builtin_ctz(children));
      if (node.is_leaf(c))
        take_leaf(node, c);
      else
        stack_[top_++] = node.first[c];
    }
  }

  HWY_INLINE void meet(const TriangleQuad& quad, std::uint32_t count) {
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
      sum_.add(crossing(point_, at(0), at(1), at(2), ray_));
    }
  }

  const InsideTask& task_;
  const HitFilter* filter_;
  std::vector<std::uint32_t>& stack_;
  std::uint32_t top_ = 0;
  Point point_;
  std::uint32_t number_ = 0;
  TopRoots roots_;                       ///< on two levels
  float above_[3] = {}, below_[3] = {};  ///< the floats next to the point
  float up_[3] = {}, down_[3] = {};      ///< what is met
  int ray_ = kNoRay;
  Crossings sum_;
};

bool is_inside(const InsideTask& task, std::uint32_t i, CrossingWalk* walk) {
  walk->set_point(task.points[i].at, task.begin + i);
  if (task.closed) {
    const Crossings sum = walk->along_any();
    return task.rule == InsideRule::kNonZero ? sum.winding != 0 : sum.number % 2 != 0;
  }
  std::int64_t winding = 0, odd = 0;
  for (int ray = 0; ray < kAxisRays; ++ray) {
    const Crossings sum = walk->along(ray);
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
  if (task.scene->levels == nullptr && task.scene->tree->empty()) {
    std::fill_n(task.inside, task.count, std::uint8_t{0});
    return;
  }
  CrossingWalk walk(task);
  const bool is_near = task.closed && task.found != nullptr;
  const auto world_of = [&](std::uint32_t n) { return task.scene->worlds[task.begin + n]; };
  std::uint32_t before = kMostTilePoints;  // none
  for (std::uint32_t i = 0; i < task.count; ++i) {
    task.executor->check();
    const auto number = static_cast<std::uint32_t>(task.order[i] & (kMostTilePoints - 1));
    const auto distance = [&](std::uint32_t n) {  // beyond a radius nothing is known
      return task.found[n].triangle != kNoTriangle ? task.found[n].distance : task.points[n].radius;
    };
    if (is_near && before != kMostTilePoints && world_of(number) == world_of(before) &&
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
