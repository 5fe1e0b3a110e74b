// Compiled once a SIMD target and chosen at run time (Google Highway). No operation is fused, so
// that every target has the same distances.
#include <algorithm>
#include <bit>
#include <cmath>

#include "base/float.h"
#include "geom/rounding.h"
#include "nearest/nearest_kernel.h"
#include "nearest/point_triangle_body.h"
#include "nearest/tile_order.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nearest/nearest_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "nearest/lanes-inl.h"

/// The k triangles that a point has found so far, the nearest first, and the limit for others.
class NearestOfPoint {
 public:
  /// `largest`: of all coordinates of corners.
  NearestOfPoint(std::uint32_t k, FoundTriangle* found, double radius, double largest)
      : k_(k), found_(found), radius_(radius), off_(0x1p-16 * largest) {
    std::fill_n(found, k, FoundTriangle{});
    set_limit(radius);
  }

  /// Squared distances above are too far.
  [[nodiscard]] double most_squared() const { return most_squared_; }
  /// The limit for the results of `box_distances`.
  [[nodiscard]] float reach() const { return reach_; }
  /// The limit for the results of `surely_far`.
  [[nodiscard]] float far_squared() const { return far_squared_; }

  void offer(const FoundTriangle& one) {
    if (!(one.distance <= radius_) || !is_nearer(one, found_[k_ - 1])) return;
    std::uint32_t place = k_ - 1;
    for (; place > 0 && is_nearer(one, found_[place - 1]); --place)
      found_[place] = found_[place - 1];
    found_[place] = one;
    shorten(found_[k_ - 1].distance);
  }
  /// Triangles farther away are not among the nearest.
  void shorten(double distance) {
    if (distance < limit_) set_limit(distance);
  }

 private:
  void set_limit(double distance) {
    limit_ = distance;
    // A square that exceeds this has a root above the distance.
    most_squared_ = distance * distance * (1 + 0x1p-50);
    const double far = distance * (1 + 0x1p-16) + off_;
    far_squared_ = rounded_up(far * far);
    reach_ = rounded_up(most_squared_) * (1 + 0x1p-19f) + 0x1p-120f;
  }

  std::uint32_t k_;
  FoundTriangle* found_;
  double radius_, off_, limit_, most_squared_;
  float reach_, far_squared_;
};

/// One point down one tree.
class NearestWalk {
 public:
  NearestWalk(const NearestScene& scene, std::uint32_t which, std::vector<NearestStop>* stack)
      : tree_(scene[which]),
        which_(which),
        skips_points_(which == 0 && !scene.thin->empty()),
        stack_(*stack) {}

  HWY_ATTR void run(Point p, NearestOfPoint* best) {
    if (tree_.empty()) return;
    const Doubles d;
    const Lanes3 at{hn::Set(d, p.x), hn::Set(d, p.y), hn::Set(d, p.z)};
    const FloatPoint between(p);
    std::uint32_t top = 0;
    NearestStop next{0, 0, 0};
    for (;;) {
      if (next.count == 0) {
        open(between, next.first, best->reach(), &top);
      } else {
        meet(at, between.up, next, best);
      }
      do {
        if (top == 0) return;
        next = stack_[--top];
      } while (!(next.near <= best->reach()));
    }
  }

 private:
  /// Puts the children within reach on the stack, the nearest on top.
  HWY_INLINE void open(const FloatPoint& p, std::uint32_t number, float reach, std::uint32_t* top) {
    constexpr std::uint32_t kChild = kBvhWidth - 1;
    const Boxes d;
    const BvhNode& node = tree_.nodes[number];
    if (HWY_UNLIKELY(*top + kBvhWidth > stack_.size()))
      stack_.resize(2 * stack_.size() + kBvhWidth);
    alignas(32) float near[kBvhWidth];
    std::uint32_t met = 0;
    for (std::size_t g = 0; g < kBvhWidth; g += hn::Lanes(d)) {
      const BV squared = box_distances(p, node, g);
      hn::Store(squared, d, near + g);
      met |= bits_of(d, hn::Le(squared, hn::Set(d, reach))) << g;
    }
    met &= (1u << node.children) - 1;
    std::uint32_t keys[kBvhWidth], count = 0;  // from far to near: bits of floats keep their order
    for (; met != 0; met &= met - 1) {
      const auto c = static_cast<std::uint32_t>(__builtin_ctz(met));
      const std::uint32_t key = (std::bit_cast<std::uint32_t>(near[c]) & ~kChild) | c;
      std::uint32_t place = count++;
      for (; place > 0 && keys[place - 1] < key; --place) keys[place] = keys[place - 1];
      keys[place] = key;
    }
    NearestStop* to = stack_.data() + *top;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t c = keys[i] & kChild;
      *to++ = {near[c], node.first[c], node.count[c]};
    }
    *top += count;
  }

  HWY_INLINE void meet(const Lanes3& p, Vec3 up, const NearestStop& leaf, NearestOfPoint* best) {
    const Doubles d;
    for (std::uint32_t first = leaf.first, left = leaf.count;;) {
      const TriangleQuad& quad = tree_.quads[first];
      const std::uint32_t here = (1u << std::min(left, kQuadTriangles)) - 1;
      const std::uint32_t wanted = here & ~surely_far(up, quad, best->far_squared());
      for (std::size_t g = 0; g < kQuadTriangles; g += hn::Lanes(d)) {
        const std::uint32_t lanes = (1u << hn::Lanes(d)) - 1;
        if ((wanted >> g & lanes) == 0) continue;
        const DV squared = squared_to_triangles(p, quad, g);
        std::uint32_t near = bits_of(d, hn::Le(squared, hn::Set(d, best->most_squared()))) << g;
        near &= wanted;
        if (near == 0) continue;
        alignas(32) double all[kQuadTriangles];
        hn::Store(squared, d, all + g);
        for (; near != 0; near &= near - 1) {
          const auto lane = static_cast<std::uint32_t>(__builtin_ctz(near));
          if (skips_points_ && is_point(quad, lane)) continue;
          best->offer({std::sqrt(all[lane]), quad.id[lane], kQuadTriangles * first + lane, which_});
        }
      }
      if (left <= kQuadTriangles) return;
      ++first;
      left -= kQuadTriangles;
    }
  }

  const ObjectTree& tree_;
  std::uint32_t which_;
  bool skips_points_;
  std::vector<NearestStop>& stack_;
};

/// Starts from the result of the previous point in the order.
void start_from(const NearestTask& task, const QueryPoint& before, const FoundTriangle* found,
                const QueryPoint& point, NearestOfPoint* best) {
  if (task.k == 1) {
    if (found->triangle == kInvalidId) return;
    const Corners c = corners_at((*task.scene)[found->tree], found->place);
    FoundTriangle one = *found;
    one.distance = std::sqrt(
        distance_to_triangle(point.at, to_point(c.a), to_point(c.b), to_point(c.c)).squared);
    best->offer(one);
    return;
  }
  // All k of them are within this: the error of distances is far below what is added.
  const FoundTriangle& last = found[task.k - 1];
  if (last.triangle == kInvalidId) return;
  const Point step = point.at - before.at;
  best->shorten((last.distance + std::sqrt(dot(step, step))) * (1 + 0x1p-30) + task.slack);
}

HWY_ATTR void FindNearest(const NearestTask& task) {
  NearestWalk solid(*task.scene, 0, task.stack), thin(*task.scene, 1, task.stack);
  const QueryPoint* before = nullptr;
  const FoundTriangle* found_before = nullptr;
  for (std::uint32_t i = 0; i < task.count; ++i) {
    const std::uint64_t number = task.order[i] & (kMostTilePoints - 1);
    const QueryPoint& point = task.points[number];
    FoundTriangle* found = task.found + number * task.k;
    NearestOfPoint best(task.k, found, point.radius, task.slack * 0x1p38);
    if (before != nullptr) start_from(task, *before, found_before, point, &best);
    solid.run(point.at, &best);
    thin.run(point.at, &best);
    before = &point;
    found_before = found;
  }
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(FindNearest);

void find_nearest_in_order(const NearestTask& task) {
  HWY_DYNAMIC_DISPATCH(FindNearest)(task);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
