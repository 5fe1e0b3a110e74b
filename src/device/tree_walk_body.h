// Traces one ray through a tree with two boxes per node, the nearer first: the work of a thread of
// a device.
#pragma once

#include "device/ray_box_body.h"
#include "intersect/facing_body.h"
#include "intersect/float_answer_body.h"
#include "intersect/hit_filter.h"
#include "intersect/indexed_hit.h"
#include "intersect/triangle_body.h"
#include "object_tree/linear_walk_body.h"

namespace raysheaf {

/// Counts of a ray's traversal.
struct WalkCounts {
  std::uint32_t box_tests = 0, triangle_tests = 0;
  std::uint32_t leaves = 0;  ///< visited; counted only on the host, for lab/walk_counts.h
};

/// Calls `leaf(place)` for the leaves whose boxes the ray intersects, the nearer child of a node
/// first. `leaf` may shorten the ray. `levels` as `walk_linear_tree` has them.
template <class Leaf, class Levels = OneLevel>
RAYSHEAF_HD void walk_tree(const LinearTreeView& tree, BoxRay* ray, WalkCounts* counts,
                           const Leaf& leaf, Levels* levels = nullptr) {
  walk_linear_tree(
      tree,
      [&](const Box& box, float* near) {
        ++counts->box_tests;
        return enters(*ray, box, near);
      },
      [&](float near) { return near <= ray->s_far; },
      [&](std::uint32_t place) {
#ifndef __CUDA_ARCH__
        ++counts->leaves;
#endif
        leaf(place);
      },
      levels);
}

/// Triangles where they are, in one tree.
///
/// Rays on a device meet such a class, `Trees`: it has places of triangles (`Place`), the triangles
/// there with the corners that are tested, a condition for hits to count, and a form for them
/// (`Found`). A `Walk` is that of one ray.
struct TriangleTree {
  using Found = IndexedHit;
  struct Place {
    std::uint32_t triangle = kInvalidId;
  };

  LinearTreeView tree;
  Box scene;
  Facing facing = Facing::kBoth;
  HitFilter filter = {};
  std::uint32_t ray = 0;

  [[nodiscard]] RAYSHEAF_HD LinearTriangle triangle_at(Place place) const {
    return tree.triangles[place.triangle];
  }
  /// Calls `take(place, triangle)` for the triangles of the leaf that begins at `first`.
  template <class Take>
  RAYSHEAF_HD void for_each_in_leaf(Place first, const Take& take) const {
    for_each_of_leaf(
        tree.triangles, first.triangle,
        [&](const LinearTriangle& triangle, std::uint32_t at) { take(Place{at}, triangle); });
  }
  [[nodiscard]] RAYSHEAF_HD bool counts(Place /*place*/, const LinearTriangle& triangle,
                                        bool front) const {
    return shows(facing, static_cast<std::uint8_t>(triangle.flags), front) &&
           filter.lets(ray, triangle.id, front);
  }
  [[nodiscard]] RAYSHEAF_HD static Found named(Place /*place*/, const LinearTriangle& triangle,
                                               const TriangleHit& hit) {
    return {hit.t, hit.u, hit.v, triangle.id};
  }

  class Walk {
   public:
    RAYSHEAF_HD Walk(const TriangleTree& trees, const Ray& ray)
        : tree_(trees.tree), boxes_(make_box_ray(ray, trees.scene)) {}
    /// Calls `leaf(first)` for the leaves that the ray may meet, near ones first. `leaf` may
    /// shorten the ray, or end the walk.
    template <class Leaf>
    RAYSHEAF_HD void run(WalkCounts* counts, const Leaf& leaf) {
      walk_tree(tree_, &boxes_, counts, [&](std::uint32_t place) { leaf(Place{place}); });
    }
    RAYSHEAF_HD void shorten_to(float t) { shorten(&boxes_, t); }
    RAYSHEAF_HD void end() { boxes_.s_far = -std::numeric_limits<float>::infinity(); }

   private:
    LinearTreeView tree_;
    BoxRay boxes_;
  };
};

/// Whether a comes before b in a row.
RAYSHEAF_HD inline bool stands_before(const IndexedHit& a, const IndexedHit& b) {
  return a.t < b.t || (a.t == b.t && a.triangle < b.triangle);
}
RAYSHEAF_HD inline bool stands_before(const Hit& a, const Hit& b) {
  return is_before(a, b);
}

/// Calls `take(hit)` for the hits of a ray with the triangles of a leaf. `setup` has the valid
/// interval, which `take` may shorten.
template <class Trees, class Take>
RAYSHEAF_HD void meet_leaf(const Trees& trees, typename Trees::Place first, const RaySetup& setup,
                           WalkCounts* counts, const Take& take) {
  using Place = typename Trees::Place;
  trees.for_each_in_leaf(first, [&](Place place, const LinearTriangle& triangle) {
    ++counts->triangle_tests;
    TriangleHit hit;
    if (!intersect_triangle(setup, triangle.a, triangle.b, triangle.c, &hit)) return;
    if (trees.counts(place, triangle, hit.front)) take(trees.named(place, triangle, hit));
  });
}

/// The first of the hits in the order of rows.
template <class Trees>
RAYSHEAF_HD typename Trees::Found closest_in_tree(const Trees& trees, const Ray& ray,
                                                  WalkCounts* counts) {
  typename Trees::Found best;
  RaySetup setup = make_ray_setup(ray);
  typename Trees::Walk walk(trees, ray);
  walk.run(counts, [&](typename Trees::Place first) {
    meet_leaf(trees, first, setup, counts, [&](const typename Trees::Found& hit) {
      if (!stands_before(hit, best)) return;
      best = hit;
      setup.t_max = hit.t;
      walk.shorten_to(hit.t);
    });
  });
  return best;
}

/// Whether there is a hit.
template <class Trees>
RAYSHEAF_HD bool any_in_tree(const Trees& trees, const Ray& ray, WalkCounts* counts) {
  bool met = false;
  RaySetup setup = make_ray_setup(ray);
  typename Trees::Walk walk(trees, ray);
  walk.run(counts, [&](typename Trees::Place first) {
    meet_leaf(trees, first, setup, counts, [&](const typename Trees::Found&) {
      met = true;
      setup.t_max = -1;
      walk.end();
    });
  });
  return met;
}

/// The result of a traversal in binary32. The answer is among the triangles at `place`, the nearest
/// certain hit, whose t is in [low, high], and at `first` and `second`, for which binary32 cannot
/// decide whether they are hits, or nearer ones: usually the one at which the ray starts.
template <class Place>
struct FloatWalk {
  float low = 0, high = std::numeric_limits<float>::infinity();
  Place place, first, second;
  bool unsure = false;  ///< there are more; `closest_in_tree` or `any_in_tree` starts again

  RAYSHEAF_HD void keep(Place candidate) {
    if (first.triangle == kInvalidId) {
      first = candidate;
    } else if (second.triangle == kInvalidId) {
      second = candidate;
    } else {
      unsure = true;
    }
  }
};

/// Tests the triangles of the leaf that begins at `leaf`.
template <class Trees>
RAYSHEAF_HD void meet_leaf_in_floats(const Trees& trees, typename Trees::Place leaf,
                                     const RaySetup& setup, bool any, WalkCounts* counts,
                                     FloatWalk<typename Trees::Place>* best) {
  using Place = typename Trees::Place;
  trees.for_each_in_leaf(leaf, [&](Place at, const LinearTriangle& triangle) {
    ++counts->triangle_tests;
    const FloatAnswer answer = answer_in_floats(setup, triangle.a, triangle.b, triangle.c);
    if (answer.kind == FloatAnswer::kMiss) return;
    if (answer.kind == FloatAnswer::kUnsure) {
      best->keep(at);
    } else if (trees.counts(at, triangle, answer.front) && answer.low <= best->high) {
      if (!any && best->place.triangle != kInvalidId && answer.high >= best->low) {
        best->keep(at);
        best->high = answer.high < best->high ? answer.high : best->high;
      } else {
        best->low = answer.low;
        best->high = answer.high;
        best->place = at;
      }
    }
  });
}

/// Needs few registers and no double.
template <class Trees>
RAYSHEAF_HD FloatWalk<typename Trees::Place> closest_in_floats(const Trees& trees, const Ray& ray,
                                                               WalkCounts* counts) {
  FloatWalk<typename Trees::Place> best;
  const RaySetup setup = make_ray_setup(ray);
  typename Trees::Walk walk(trees, ray);
  walk.run(counts, [&](typename Trees::Place leaf) {
    meet_leaf_in_floats(trees, leaf, setup, false, counts, &best);
    walk.shorten_to(best.high);
    if (best.unsure) walk.end();
  });
  return best;
}

/// The same for any hit: the hit at `place` is the answer.
template <class Trees>
RAYSHEAF_HD FloatWalk<typename Trees::Place> any_in_floats(const Trees& trees, const Ray& ray,
                                                           WalkCounts* counts) {
  FloatWalk<typename Trees::Place> found;
  const RaySetup setup = make_ray_setup(ray);
  typename Trees::Walk walk(trees, ray);
  walk.run(counts, [&](typename Trees::Place leaf) {
    meet_leaf_in_floats(trees, leaf, setup, true, counts, &found);
    if (found.place.triangle != kInvalidId) walk.end();
  });
  found.unsure = found.unsure && found.place.triangle == kInvalidId;
  return found;
}

/// Tests the triangle at a place, if there is one, in binary64 only. Returns whether the result is
/// certain.
template <class Trees>
RAYSHEAF_HD bool meet_in_doubles(const Trees& trees, typename Trees::Place place, const Ray& ray,
                                 typename Trees::Found* best) {
  if (place.triangle == kInvalidId) return true;
  const LinearTriangle t = trees.triangle_at(place);
  TriangleHit hit;
  const LineAnswer answer = answer_in_doubles(ray.origin, ray.direction, t.a, t.b, t.c, &hit);
  if (answer == LineAnswer::kMeets && is_within(hit.t, ray.t_min, ray.t_max) &&
      trees.counts(place, t, hit.front)) {
    const typename Trees::Found one = trees.named(place, t, hit);
    if (stands_before(one, *best)) *best = one;
  }
  return answer != LineAnswer::kUnsure;
}

/// Calls `take(hit)` for every hit, in no particular order.
template <class Trees, class Take>
RAYSHEAF_HD void all_in_tree(const Trees& trees, const Ray& ray, WalkCounts* counts,
                             const Take& take) {
  const RaySetup setup = make_ray_setup(ray);
  typename Trees::Walk walk(trees, ray);
  walk.run(counts,
           [&](typename Trees::Place first) { meet_leaf(trees, first, setup, counts, take); });
}

/// Sorts a ray's hits in place by a heap (J. W. J. Williams, "Algorithm 232: Heapsort", 1964), so
/// that a long row takes O(n log n) and no memory.
template <class Found>
RAYSHEAF_HD void sort_row(Found* hits, std::uint64_t count) {
  const auto sink = [&](std::uint64_t at, std::uint64_t end) {
    const Found hit = hits[at];
    for (std::uint64_t child = 2 * at + 1; child < end; child = 2 * at + 1) {
      if (child + 1 < end && stands_before(hits[child], hits[child + 1])) ++child;
      if (!stands_before(hit, hits[child])) break;
      hits[at] = hits[child];
      at = child;
    }
    hits[at] = hit;
  };
  for (std::uint64_t i = count / 2; i-- > 0;) sink(i, count);
  for (std::uint64_t end = count; end-- > 1;) {
    const Found last = hits[end];
    hits[end] = hits[0];
    hits[0] = last;
    sink(0, end);
  }
}

}  // namespace raysheaf
