// One point through a tree with two boxes a node: its nearest triangles, the nearer box first, and
// the triangles that rays from it cross. The work of a thread of a device; all decisions are those
// of nearest/point_triangle_body.h and nearest/crossing_body.h.
#pragma once

#include <cmath>

#include "base/vec.h"
#include "geom/rounding.h"
#include "nearest/crossing_body.h"
#include "nearest/point_triangle_body.h"
#include "object_tree/linear_walk_body.h"

namespace raysheaf {

/// A triangle by its number.
struct NearTriangle {
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = kInvalidId;
};

/// As `is_nearer` of nearest/nearest.h.
RAYSHEAF_HD inline bool comes_before(const NearTriangle& a, const NearTriangle& b) {
  return a.distance < b.distance || (a.distance == b.distance && a.triangle < b.triangle);
}

/// The floats next to a point: comparisons of floats with them are those with the point.
struct PointFloats {
  Vec3 down, up;

  RAYSHEAF_HD explicit PointFloats(Point p)
      : down{-rounded_up(-p.x), -rounded_up(-p.y), -rounded_up(-p.z)},
        up{rounded_up(p.x), rounded_up(p.y), rounded_up(p.z)} {}
};

/// At most the squared distance from the point to anything in the box, except for roundings, which
/// `NearestLimit::reach` makes up for: the distance to a box is nowhere above the computed one to a
/// triangle in it.
RAYSHEAF_HD inline float box_distance(const PointFloats& p, const Box& box) {
  const Vec3 gap = max(max(box.min - p.up, p.down - box.max), Vec3{0, 0, 0});
  return dot(gap, gap);
}

/// The nearest triangle.
struct NearestOne {
  NearestLimit limit;
  NearTriangle best;

  RAYSHEAF_HD explicit NearestOne(double radius) : limit(radius) {}
  RAYSHEAF_HD void offer(const NearTriangle& one) {
    if (!(one.distance <= limit.distance) || !comes_before(one, best)) return;
    best = one;
    limit.set(one.distance);
  }
};

/// Lets the triangle at `at` of a heap of `count`, whose farthest is on top, sink to its place (J.
/// W. J. Williams, "Algorithm 232: Heapsort", 1964).
RAYSHEAF_HD inline void sink_near(NearTriangle* heap, std::uint32_t at, std::uint32_t count) {
  const NearTriangle one = heap[at];
  for (std::uint32_t child = 2 * at + 1; child < count; child = 2 * at + 1) {
    if (child + 1 < count && comes_before(heap[child], heap[child + 1])) ++child;
    if (!comes_before(one, heap[child])) break;
    heap[at] = heap[child];
    at = child;
  }
  heap[at] = one;
}

/// The k nearest triangles, in memory of the caller's.
struct NearestSome {
  NearestLimit limit;
  NearTriangle* heap;
  std::uint32_t most, count = 0;

  RAYSHEAF_HD NearestSome(double radius, NearTriangle* room, std::uint32_t k)
      : limit(radius), heap(room), most(k) {}
  RAYSHEAF_HD void offer(const NearTriangle& one) {
    if (!(one.distance <= limit.distance)) return;
    if (count == most) {
      if (!comes_before(one, heap[0])) return;
      heap[0] = one;
      sink_near(heap, 0, count);
    } else {
      std::uint32_t at = count++;
      for (; at > 0 && comes_before(heap[(at - 1) / 2], one); at = (at - 1) / 2)
        heap[at] = heap[(at - 1) / 2];
      heap[at] = one;
    }
    if (count == most) limit.set(heap[0].distance);
  }
  /// The nearest first, and none behind the last.
  RAYSHEAF_HD void sort() {
    for (std::uint32_t end = count; end-- > 1;) {
      const NearTriangle last = heap[end];
      heap[end] = heap[0];
      heap[0] = last;
      sink_near(heap, 0, end);
    }
    for (std::uint32_t i = count; i < most; ++i) heap[i] = NearTriangle{};
  }
};

template <class Nearest>
RAYSHEAF_HD void meet_triangle(Point p, std::uint32_t number, Vec3 a, Vec3 b, Vec3 c,
                               Nearest* nearest) {
  const double squared = distance_to_triangle(p, to_point(a), to_point(b), to_point(c)).squared;
  if (squared <= nearest->limit.most_squared) nearest->offer({std::sqrt(squared), number});
}

/// Offers the triangles of the tree that may be among the nearest.
template <class Nearest>
RAYSHEAF_HD void nearest_in_tree(const LinearTreeView& tree, Point p, Nearest* nearest) {
  const PointFloats floats(p);
  const auto is_near = [&](float distance) { return distance <= nearest->limit.reach; };
  walk_linear_tree(
      tree,
      [&](const Box& box, float* distance) {
        *distance = box_distance(floats, box);
        return is_near(*distance);
      },
      is_near,
      [&](std::uint32_t leaf) {
        for_each_of_leaf(tree.triangles, leaf, [&](const LinearTriangle& t, std::uint32_t) {
          if (is_near(box_distance(floats, triangle_box(t.a, t.b, t.c))))
            meet_triangle(p, t.id, t.a, t.b, t.c, nearest);
        });
      });
}

/// Whether a ray along an axis (nearest/crossing_body.h) may cross what is in the box. A point that
/// counts as moved leaves no box of which it is at the border.
RAYSHEAF_HD inline bool may_cross(const PointFloats& p, const Box& box, int ray) {
  const int axis = ray % 3, i = (axis + 1) % 3, k = (axis + 2) % 3;
  const auto over = [&](int a) {
    return component(box.min, a) <= component(p.down, a) &&
           component(box.max, a) >= component(p.up, a);
  };
  const bool before = ray < 3 ? component(box.max, axis) >= component(p.up, axis)
                              : component(box.min, axis) <= component(p.down, axis);
  return before && over(i) && over(k);
}

/// The sum over the triangles of the tree.
RAYSHEAF_HD inline Crossings crossings_of(const LinearTreeView& tree, Point p, int ray) {
  Crossings sum;
  const PointFloats floats(p);
  walk_linear_tree(
      tree,
      [&](const Box& box, float* near) {
        *near = 0;
        return may_cross(floats, box, ray);
      },
      [](float) { return true; },
      [&](std::uint32_t leaf) {
        for_each_of_leaf(tree.triangles, leaf, [&](const LinearTriangle& t, std::uint32_t) {
          if (may_cross(floats, triangle_box(t.a, t.b, t.c), ray))
            sum.add(crossing(p, to_point(t.a), to_point(t.b), to_point(t.c), ray));
        });
      });
  return sum;
}

/// The ray that leaves the box of all triangles after the shortest way.
RAYSHEAF_HD inline int shortest_ray(const PointFloats& p, const Box& scene) {
  int best = 0;
  float least = std::numeric_limits<float>::infinity();
  for (int ray = 0; ray < kAxisRays; ++ray) {
    const int axis = ray % 3;
    const float way = ray < 3 ? component(scene.max, axis) - component(p.down, axis)
                              : component(p.up, axis) - component(scene.min, axis);
    if (way < least) {
      least = way;
      best = ray;
    }
  }
  return best;
}

/// The answer of raysheaf/points.h by the sums over `rays` rays: the winding numbers, or how many
/// rays cross an odd number of triangles.
RAYSHEAF_HD inline bool is_inside(std::int64_t sum, int rays) {
  return 2 * (sum < 0 ? -sum : sum) > rays;
}

}  // namespace raysheaf
