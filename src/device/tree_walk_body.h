// Traces one ray through a tree with two boxes per node, the nearer first: the work of a thread of
// a device.
#pragma once

#include "device/ray_box_body.h"
#include "intersect/facing_body.h"
#include "intersect/float_answer_body.h"
#include "intersect/indexed_hit.h"
#include "intersect/triangle_body.h"
#include "object_tree/linear_walk_body.h"

namespace raysheaf {

/// Counts of a ray's traversal.
struct WalkCounts {
  std::uint32_t box_tests = 0, triangle_tests = 0;
  std::uint32_t leaves = 0;  ///< visited; counted only on the host, for lab/walk_counts.h
};

/// Calls `take(hit)` for the hits of a ray with the triangles of a leaf. `setup` has the valid
/// interval, which `take` may shorten.
template <class Take>
RAYSHEAF_HD void meet_leaf(const LinearTreeView& tree, std::uint32_t place, Facing facing,
                           const RaySetup& setup, WalkCounts* counts, const Take& take) {
  for_each_of_leaf(tree.triangles, place, [&](const LinearTriangle& triangle, std::uint32_t) {
    ++counts->triangle_tests;
    TriangleHit hit;
    if (!intersect_triangle(setup, triangle.a, triangle.b, triangle.c, &hit)) return;
    if (!shows(facing, static_cast<std::uint8_t>(triangle.flags), hit.front)) return;
    take(IndexedHit{hit.t, hit.u, hit.v, triangle.id});
  });
}

/// Calls `leaf(place)` for the leaves whose boxes the ray intersects, the nearer child of a node
/// first. `leaf` may shorten the ray.
template <class Leaf>
RAYSHEAF_HD void walk_tree(const LinearTreeView& tree, BoxRay* ray, WalkCounts* counts,
                           const Leaf& leaf) {
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
      });
}

/// The hit with the least (t, triangle).
RAYSHEAF_HD inline IndexedHit closest_in_tree(const LinearTreeView& tree, const Box& scene,
                                              const Ray& ray, Facing facing, WalkCounts* counts) {
  IndexedHit best;
  RaySetup setup = make_ray_setup(ray);
  BoxRay boxes = make_box_ray(ray, scene);
  walk_tree(tree, &boxes, counts, [&](std::uint32_t place) {
    meet_leaf(tree, place, facing, setup, counts, [&](const IndexedHit& hit) {
      if (!(hit.t < best.t || (hit.t == best.t && hit.triangle < best.triangle))) return;
      best = hit;
      setup.t_max = hit.t;
      shorten(&boxes, hit.t);
    });
  });
  return best;
}

/// Whether there is a hit.
RAYSHEAF_HD inline bool any_in_tree(const LinearTreeView& tree, const Box& scene, const Ray& ray,
                                    Facing facing, WalkCounts* counts) {
  bool met = false;
  RaySetup setup = make_ray_setup(ray);
  BoxRay boxes = make_box_ray(ray, scene);
  walk_tree(tree, &boxes, counts, [&](std::uint32_t place) {
    meet_leaf(tree, place, facing, setup, counts, [&](const IndexedHit&) {
      met = true;
      setup.t_max = -1;
      boxes.s_far = -std::numeric_limits<float>::infinity();
    });
  });
  return met;
}

/// The result of a traversal in binary32. The answer is among the triangles at `place`, the nearest
/// certain hit, whose t is in [low, high], and at `first` and `second`, for which binary32 cannot
/// decide whether they are hits, or nearer ones: usually the one at which the ray starts.
struct FloatWalk {
  float low = 0, high = std::numeric_limits<float>::infinity();
  std::uint32_t place = kInvalidId, first = kInvalidId, second = kInvalidId;
  bool unsure = false;  ///< there are more; `closest_in_tree` or `any_in_tree` starts again

  RAYSHEAF_HD void keep(std::uint32_t candidate) {
    if (first == kInvalidId) {
      first = candidate;
    } else if (second == kInvalidId) {
      second = candidate;
    } else {
      unsure = true;
    }
  }
};

/// Tests the triangles of the leaf that begins at `place`.
RAYSHEAF_HD inline void meet_leaf_in_floats(const LinearTreeView& tree, std::uint32_t place,
                                            Facing facing, const RaySetup& setup, bool any,
                                            WalkCounts* counts, FloatWalk* best) {
  for_each_of_leaf(tree.triangles, place, [&](const LinearTriangle& triangle, std::uint32_t at) {
    ++counts->triangle_tests;
    const FloatAnswer answer = answer_in_floats(setup, triangle.a, triangle.b, triangle.c);
    if (answer.kind == FloatAnswer::kMiss) return;
    if (answer.kind == FloatAnswer::kUnsure) {
      best->keep(at);
    } else if (shows(facing, static_cast<std::uint8_t>(triangle.flags), answer.front) &&
               answer.low <= best->high) {
      if (!any && best->place != kInvalidId && answer.high >= best->low) {
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
RAYSHEAF_HD inline FloatWalk closest_in_floats(const LinearTreeView& tree, const Box& scene,
                                               const Ray& ray, Facing facing, WalkCounts* counts) {
  FloatWalk best;
  const RaySetup setup = make_ray_setup(ray);
  BoxRay boxes = make_box_ray(ray, scene);
  walk_tree(tree, &boxes, counts, [&](std::uint32_t place) {
    meet_leaf_in_floats(tree, place, facing, setup, false, counts, &best);
    shorten(&boxes, best.high);
    if (best.unsure) boxes.s_far = -std::numeric_limits<float>::infinity();
  });
  return best;
}

/// The same for any hit: the hit at `place` is the answer.
RAYSHEAF_HD inline FloatWalk any_in_floats(const LinearTreeView& tree, const Box& scene,
                                           const Ray& ray, Facing facing, WalkCounts* counts) {
  FloatWalk found;
  const RaySetup setup = make_ray_setup(ray);
  BoxRay boxes = make_box_ray(ray, scene);
  walk_tree(tree, &boxes, counts, [&](std::uint32_t place) {
    meet_leaf_in_floats(tree, place, facing, setup, true, counts, &found);
    if (found.place != kInvalidId) boxes.s_far = -std::numeric_limits<float>::infinity();
  });
  found.unsure = found.unsure && found.place == kInvalidId;
  return found;
}

/// Tests the triangle at a place, if it is not `kInvalidId`, in binary64 only. Returns whether the
/// result is certain.
RAYSHEAF_HD inline bool meet_in_doubles(const LinearTreeView& tree, std::uint32_t place,
                                        const Ray& ray, Facing facing, IndexedHit* best) {
  if (place == kInvalidId) return true;
  const LinearTriangle t = tree.triangles[place];
  TriangleHit hit;
  const LineAnswer answer = answer_in_doubles(ray.origin, ray.direction, t.a, t.b, t.c, &hit);
  if (answer == LineAnswer::kMeets && is_within(hit.t, ray.t_min, ray.t_max) &&
      shows(facing, static_cast<std::uint8_t>(t.flags), hit.front) &&
      (hit.t < best->t || (hit.t == best->t && t.id < best->triangle)))
    *best = {hit.t, hit.u, hit.v, t.id};
  return answer != LineAnswer::kUnsure;
}

/// Calls `take(hit)` for every hit, in no particular order.
template <class Take>
RAYSHEAF_HD void all_in_tree(const LinearTreeView& tree, const Box& scene, const Ray& ray,
                             Facing facing, WalkCounts* counts, const Take& take) {
  const RaySetup setup = make_ray_setup(ray);
  BoxRay boxes = make_box_ray(ray, scene);
  walk_tree(tree, &boxes, counts,
            [&](std::uint32_t place) { meet_leaf(tree, place, facing, setup, counts, take); });
}

/// Whether a comes before b in a row.
RAYSHEAF_HD inline bool stands_before(const IndexedHit& a, const IndexedHit& b) {
  return a.t < b.t || (a.t == b.t && a.triangle < b.triangle);
}

/// Sorts a ray's hits in place by a heap (J. W. J. Williams, "Algorithm 232: Heapsort", 1964), so
/// that a long row takes O(n log n) and no memory.
RAYSHEAF_HD inline void sort_row(IndexedHit* hits, std::uint64_t count) {
  const auto sink = [&](std::uint64_t at, std::uint64_t end) {
    const IndexedHit hit = hits[at];
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
    const IndexedHit last = hits[end];
    hits[end] = hits[0];
    hits[0] = last;
    sink(0, end);
  }
}

}  // namespace raysheaf
