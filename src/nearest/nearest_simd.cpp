// Compiled once a SIMD target and chosen at run time (Google Highway). No operation is fused, so
// that every target has the same distances.
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/float.h"
#include "geom/rounding.h"
#include "nearest/nearest_kernel.h"
#include "nearest/point_triangle_body.h"
#include "nearest/tile_order.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nearest/nearest_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"
#include "levels/placed-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "nearest/lanes-inl.h"

/// The k triangles that a point has found so far, the nearest first, and the limit for others.
class NearestOfPoint {
 public:
  NearestOfPoint() = default;
  /// `largest`: of all coordinates of corners.
  NearestOfPoint(std::uint32_t k, FoundTriangle* found, double radius, double largest)
      : k_(k), found_(found), radius_(radius), off_(0x1p-40 * largest) {
    std::fill_n(found, k, FoundTriangle{});
    set_limit(radius);
  }

  /// Distances above are too far.
  [[nodiscard]] double limit() const { return limit_.distance; }
  /// Squared distances above are too far.
  [[nodiscard]] double most_squared() const { return limit_.most_squared; }
  /// The limit for the results of `box_distances`.
  [[nodiscard]] float reach() const { return limit_.reach; }
  /// The limit for the results of `maybe_near`.
  [[nodiscard]] float far_squared() const { return far_squared_; }

  /// Whether it is one of them.
  bool offer(const FoundTriangle& one) {
    if (!(one.distance <= radius_) || !is_nearer(one, found_[k_ - 1])) return false;
    std::uint32_t place = k_ - 1;
    for (; place > 0 && is_nearer(one, found_[place - 1]); --place)
      found_[place] = found_[place - 1];
    found_[place] = one;
    shorten(found_[k_ - 1].distance);
    return true;
  }
  /// Triangles farther away are not among the nearest.
  void shorten(double distance) {
    if (distance < limit_.distance) set_limit(distance);
  }

 private:
  void set_limit(double distance) {
    limit_.set(distance);
    const double far = distance * (1 + 0x1p-16) + off_;
    // No smaller than the square, except for the smallest floats.
    far_squared_ = static_cast<float>(far * far) * (1 + 0x1p-22f);
  }

  std::uint32_t k_ = 0;
  FoundTriangle* found_ = nullptr;
  double radius_ = 0, off_ = 0;
  NearestLimit limit_;
  float far_squared_ = 0;
};

/// Neighbours on their way. Squares of floats tell distances apart to a part in 2^19. That is too
/// little for points many lengths of the scene away from it, so if there are such points
/// (`is_far`), distances are computed in binary64, and those to the box of the scene are subtracted
/// (`base`).
struct PointBundle {
  Point at[kBundlePoints];
  std::uint32_t number[kBundlePoints];     ///< among all
  alignas(64) double x[3][kBundlePoints];  ///< the same in columns
  NearestOfPoint best[kBundlePoints];
  BundleLanes lanes;
  std::uint32_t count = 0;
  bool is_far = false;
  alignas(64) double base[kBundlePoints] = {};

  /// Distances in binary64 are wrong by less than this share.
  static constexpr double kShare = 0x1p-48;
  /// Points this many lengths away from the scene are far.
  static constexpr double kFarLengths = 256;

  void add(Point p, std::uint32_t of_all, const NearestOfPoint& of_point) {
    number[count] = of_all;
    for (int axis = 0; axis < 3; ++axis) {
      const double here = component(p, axis);
      x[axis][count] = here;
      lanes.set(count, axis, here);
      lanes.rest[axis][count] = static_cast<float>(here - double{lanes.up[axis][count]});
    }
    at[count] = p;
    best[count] = of_point;
    update(count++);
  }
  void update(std::uint32_t i) {
    const double beyond = best[i].limit() * (1 + kShare) - base[i];
    lanes.reach[i] = is_far ? rounded_up(beyond) : best[i].reach();
    lanes.far[i] = best[i].far_squared();
  }
  /// After the last point: lanes behind it, and how far away the points are.
  void close(const Box& scene) {
    for (std::uint32_t i = count; i < kBundlePoints; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        x[axis][i] = x[axis][0];
        lanes.up[axis][i] = lanes.up[axis][0];
        lanes.down[axis][i] = lanes.down[axis][0];
        lanes.rest[axis][i] = lanes.rest[axis][0];
      }
      lanes.reach[i] = -std::numeric_limits<float>::infinity();
      lanes.far[i] = 0;
    }
    const Doubles d;
    for (std::size_t g = 0; g < kBundlePoints; g += hn::Lanes(d))
      hn::Store(distances_to_box(
                    x, g, [&](int axis) { return component(scene.min, axis); },
                    [&](int axis) { return component(scene.max, axis); }),
                d, base + g);
    const double far = kFarLengths * double{max_component(scene.max - scene.min)};
    is_far = *std::max_element(base, base + kBundlePoints) > far;
    for (std::uint32_t i = 0; is_far && i < count; ++i) update(i);
  }
};

/// The points of a bundle in the space of a mesh of which an instance is nearly similar
/// (scene/placing.h).
struct EnteredPoints {
  const Placing* placing = nullptr;
  BoxLanes lanes = {};  ///< of the others anything
  double gap[kBundlePoints];

  /// Only these points enter.
  void enter(const Placing& where, const PointBundle& bundle, std::uint32_t points) {
    placing = &where;
    std::fill_n(lanes.reach, kBundlePoints, -std::numeric_limits<float>::infinity());
    const auto& m = where.map.m;
    for (; points != 0; points &= points - 1) {
      const auto i = static_cast<std::uint32_t>(__builtin_ctz(points));
      const Point q = bundle.at[i], from = q - Point{m[0][3], m[1][3], m[2][3]};
      for (int axis = 0; axis < 3; ++axis)
        lanes.set(i, axis, where.to_mesh(axis, from.x, from.y, from.z));
      gap[i] = where.gap_of(std::sqrt(dot(q, q)));
      update(i, bundle.best[i].limit());
    }
  }
  void update(std::uint32_t i, double limit) {
    lanes.reach[i] = NearestLimit((limit * (1 + 0x1p-40) + gap[i]) / placing->stretch).reach;
  }
};

/// The names of a tree's triangles.
struct QuadNames {
  std::uint64_t first = 0;    ///< is added to their numbers in the tree
  std::uint32_t tree = 0;     ///< as in `FoundTriangle`
  bool skips_points = false;  ///< triangles without area are in another tree
};

/// A bundle down one tree after another.
class BundleWalk {
 public:
  BundleWalk(const HitFilter* filter, std::vector<NearestStop>* stack, PointBundle* bundle)
      : filter_(filter), stack_(*stack), bundle_(*bundle) {}

  void meet_flat(const NearestScene& scene) {
    meet_tree(*scene.tree, {0, 0, !scene.thin->empty()});
    meet_tree(*scene.thin, {0, 1, false});
  }
  void meet_levels(const LevelScene& levels, const TopRoots& roots, std::uint32_t mask) {
    for (const TopRoot& root : roots.of) {
      if (root.tree == nullptr) continue;
      walk(
          bundle_.lanes, [&](std::uint32_t n) -> const BvhNode& { return root.tree->nodes[n]; },
          [&](std::uint32_t number, std::uint32_t /*count*/, std::uint32_t points) {
            const LevelInstance& instance = levels.instances[number];
            if ((instance.mask & mask) != 0)
              meet_instance(instance, {std::uint64_t{number} << 32, number, false}, points);
          },
          root.node);
    }
  }

 private:
  void meet_tree(const ObjectTree& tree, const QuadNames& names) {
    if (tree.empty()) return;
    walk(
        bundle_.lanes, [&](std::uint32_t n) -> const BvhNode& { return tree.nodes[n]; },
        [&](std::uint32_t first, std::uint32_t count, std::uint32_t points) {
          for_each_quad(first, count, [&](std::uint32_t q, std::uint32_t triangles) {
            meet_quad(tree.quads[q], q, triangles, points, names);
          });
        });
  }

  void meet_instance(const LevelInstance& instance, const QuadNames& names, std::uint32_t points) {
    const ObjectTree& tree = *instance.tree;
    const Placing& placing = instance.placing;
    if (placing.is_identity) return meet_tree(tree, names);
    const auto meet = [&](std::uint32_t first, std::uint32_t count, std::uint32_t here) {
      for_each_quad(first, count, [&](std::uint32_t q, std::uint32_t triangles) {
        TriangleQuad placed;
        place_quad(placing, tree.quads[q], &placed);
        meet_quad(placed, q, triangles, here, names);
      });
    };
    if (placing.stretch > 0 && !bundle_.is_far) {
      EnteredPoints entered;
      entered.enter(placing, bundle_, points);
      entered_ = &entered;
      walk(
          entered.lanes, [&](std::uint32_t n) -> const BvhNode& { return tree.nodes[n]; }, meet);
      entered_ = nullptr;
    } else {
      BvhNode placed;
      walk(
          bundle_.lanes,
          [&](std::uint32_t n) -> const BvhNode& {
            place_node(placing, tree.nodes[n], &placed);
            return placed;
          },
          meet);
    }
  }

  /// Down the tree whose nodes `node` returns, from `root` on, with boxes where `lanes` are, to
  /// `meet(first, count, points)` for each leaf and the points that it is within reach of.
  template <class Node, class Meet>
  HWY_INLINE void walk(const BoxLanes& lanes, const Node& node, const Meet& meet,
                       std::uint32_t root = 0) {
    const std::uint32_t bottom = top_;
    open(lanes, node(root));
    while (top_ > bottom) {
      const NearestStop& stop = stack_[--top_];
      const std::uint32_t points = within_reach(lanes, stop.near);
      if (points == 0) continue;
      if (stop.count == 0)
        open(lanes, node(stop.first));
      else
        meet(stop.first, stop.count, points);
    }
  }

  HWY_INLINE static std::uint32_t within_reach(const BoxLanes& p, const float* near) {
    const Lanes d;
    std::uint32_t points = 0;
    for (std::size_t g = 0; g < kBundlePoints; g += hn::Lanes(d))
      points |= bits_of(d, hn::Le(hn::Load(d, near + g), hn::Load(d, p.reach + g))) << g;
    return points;
  }

  /// Distances to a child's box beyond `base`, rounded down.
  HWY_NOINLINE static void far_box_distances(const PointBundle& bundle, const BvhNode& node,
                                             std::uint32_t child, float* near) {
    using hn::Mul, hn::Sub;
    const Doubles d;
    const Singles df;
    for (std::size_t g = 0; g < kBundlePoints; g += hn::Lanes(d)) {
      const DV distance = distances_to_box(
          bundle.x, g, [&](int axis) { return node.bound[axis][child]; },
          [&](int axis) { return node.bound[3 + axis][child]; });
      const DV beyond =
          Sub(Mul(distance, hn::Set(d, 1 - PointBundle::kShare)), hn::Load(d, bundle.base + g));
      const auto nearest = hn::DemoteTo(df, beyond);
      const auto rounding =
          hn::Add(hn::Mul(hn::Abs(nearest), hn::Set(df, 0x1p-22f)), hn::Set(df, 0x1p-140f));
      hn::Store(hn::Sub(nearest, rounding), df, near + g);
    }
  }

  /// Puts the children within reach of any point on the stack, on top the one that is nearest to
  /// the first.
  HWY_INLINE void open(const BoxLanes& lanes, const BvhNode& node) {
    const Lanes d;
    if (HWY_UNLIKELY(top_ + kBvhWidth > stack_.size()))
      stack_.resize(2 * stack_.size() + kBvhWidth);
    NearestStop* const bottom = stack_.data() + top_;
    std::uint32_t count = 0;
    for (std::uint32_t c = 0; c < node.children; ++c) {
      NearestStop& stop = bottom[count];
      if (HWY_UNLIKELY(bundle_.is_far)) {
        far_box_distances(bundle_, node, c, stop.near);
      } else {
        for (std::size_t g = 0; g < kBundlePoints; g += hn::Lanes(d))
          hn::Store(box_distances(lanes, node, c, g), d, stop.near + g);
      }
      if (within_reach(lanes, stop.near) == 0) continue;
      stop.first = node.first[c];
      stop.count = node.count[c];
      ++count;
    }
    if (count == 0) return;
    NearestStop* nearest = bottom;
    for (std::uint32_t i = 1; i < count; ++i)
      if (bottom[i].near[0] < nearest->near[0]) nearest = &bottom[i];
    std::swap(*nearest, bottom[count - 1]);
    top_ += count;
  }

  /// Calls `meet(quad, triangles)` for the quads of a leaf, and bits of the triangles in them.
  template <class Meet>
  HWY_INLINE static void for_each_quad(std::uint32_t first, std::uint32_t left, const Meet& meet) {
    for (;; ++first, left -= kQuadTriangles) {
      meet(first, (1u << std::min(left, kQuadTriangles)) - 1);
      if (left <= kQuadTriangles) return;
    }
  }

  HWY_INLINE void meet_quad(const TriangleQuad& quad, std::uint32_t number, std::uint32_t triangles,
                            std::uint32_t points, const QuadNames& names) {
    const Lanes d;
    if (HWY_LIKELY(!bundle_.is_far)) {
      std::uint32_t any = 0;
      for (std::uint32_t lane = 0; (triangles >> lane) != 0; ++lane)
        for (std::size_t g = 0; g < kBundlePoints; g += hn::Lanes(d))
          any |= maybe_near(bundle_.lanes, quad, lane, g) << g;
      points &= any;
    }
    if (points != 0) settle(quad, number, triangles, points, names);
  }

  /// In binary64, for the points of a set.
  HWY_INLINE void settle(const TriangleQuad& quad, std::uint32_t number, std::uint32_t triangles,
                         std::uint32_t points, const QuadNames& names) {
    const Doubles d;
    while (points != 0) {
      std::uint32_t at[kPointsAtOnce], count = 0;
      alignas(64) double x[3][kPointsAtOnce * kQuadTriangles];
      alignas(64) double squared[kPointsAtOnce * kQuadTriangles];
      for (; points != 0 && count < kPointsAtOnce; points &= points - 1)
        at[count++] = static_cast<std::uint32_t>(__builtin_ctz(points));
      for (std::uint32_t i = 0; i < kPointsAtOnce; ++i) {
        const Point& p = bundle_.at[at[std::min(i, count - 1)]];
        for (std::uint32_t lane = 0; lane < kQuadTriangles; ++lane) {
          x[0][kQuadTriangles * i + lane] = p.x;
          x[1][kQuadTriangles * i + lane] = p.y;
          x[2][kQuadTriangles * i + lane] = p.z;
        }
      }
      for (std::size_t g = 0; g < kPointsAtOnce * kQuadTriangles; g += hn::Lanes(d)) {
        const DV3 p{hn::Load(d, x[0] + g), hn::Load(d, x[1] + g), hn::Load(d, x[2] + g)};
        hn::Store(squared_to_triangles(p, quad, g % kQuadTriangles), d, squared + g);
      }
      for (std::uint32_t i = 0; i < count; ++i)
        take(quad, number, triangles, squared + kQuadTriangles * i, at[i], names);
    }
  }

  HWY_INLINE void take(const TriangleQuad& quad, std::uint32_t number, std::uint32_t triangles,
                       const double* squared, std::uint32_t point, const QuadNames& names) {
    NearestOfPoint& best = bundle_.best[point];
    bool any = false;
    for (; triangles != 0; triangles &= triangles - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(triangles));
      if (!(squared[lane] <= best.most_squared())) continue;
      if (names.skips_points && is_point(quad, lane)) continue;
      if (filter_ != nullptr && !filter_->shows(bundle_.number[point], quad.id[lane])) continue;
      any |= best.offer({std::sqrt(squared[lane]), names.first + quad.id[lane],
                         kQuadTriangles * number + lane, names.tree});
    }
    if (!any) return;
    bundle_.update(point);
    if (entered_ != nullptr) entered_->update(point, best.limit());
  }

  const HitFilter* filter_;  ///< of flat triangles; null: points see all
  std::vector<NearestStop>& stack_;
  PointBundle& bundle_;
  EnteredPoints* entered_ = nullptr;  ///< where points have entered an instance
  std::uint32_t top_ = 0;
};

/// Starts from the result of the previous point in the order.
void start_from(const NearestTask& task, const QueryPoint& before, const FoundTriangle* found,
                const QueryPoint& point, NearestOfPoint* best) {
  if (task.k == 1) {
    if (found->triangle == kNoTriangle) return;
    const Corners c = task.scene->corners(*found);
    FoundTriangle one = *found;
    one.distance = std::sqrt(
        distance_to_triangle(point.at, to_point(c.a), to_point(c.b), to_point(c.c)).squared);
    best->offer(one);
    return;
  }
  // All k of them are within this: the error of distances is far below what is added.
  const FoundTriangle& last = found[task.k - 1];
  if (last.triangle == kNoTriangle) return;
  const Point step = point.at - before.at;
  best->shorten((last.distance + std::sqrt(dot(step, step))) * (1 + 0x1p-30) + task.slack);
}

void FindNearest(const NearestTask& task) {
  const NearestScene& scene = *task.scene;
  const auto number_of = [&](std::uint32_t i) {
    return static_cast<std::uint32_t>(task.order[i] & (kMostTilePoints - 1));
  };
  const auto world_of = [&](std::uint32_t i) { return scene.worlds[task.begin + number_of(i)]; };
  const QueryPoint* before = nullptr;
  const FoundTriangle* found_before = nullptr;
  for (std::uint32_t first = 0, end = 0; first < task.count; first = end) {
    task.executor->check();
    PointBundle bundle;
    const WorldId world = world_of(first);
    // In another world, or with a filter, a point may not see what the one before has found.
    if (scene.filter != nullptr || (first > 0 && world_of(first - 1) != world)) before = nullptr;
    for (; end < task.count && bundle.count < kBundlePoints && world_of(end) == world; ++end) {
      const std::uint32_t number = number_of(end);
      const QueryPoint& point = task.points[number];
      NearestOfPoint best(task.k, task.found + std::size_t{number} * task.k, point.radius,
                          task.slack * 0x1p38);
      if (before != nullptr) start_from(task, *before, found_before, point, &best);
      bundle.add(point.at, task.begin + number, best);
    }
    BundleWalk walk(scene.filter, task.stack, &bundle);
    if (scene.levels != nullptr) {
      const TopRoots roots = roots_of(*scene.levels, world);
      bundle.close(roots.bounds);
      walk.meet_levels(*scene.levels, roots, scene.mask);
    } else {
      bundle.close(scene.bounds());
      walk.meet_flat(scene);
    }
    before = task.points + number_of(end - 1);
    found_before = task.found + std::size_t{number_of(end - 1)} * task.k;
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
