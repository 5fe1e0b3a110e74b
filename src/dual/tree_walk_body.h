// One ray down a tree of two boxes a node, the nearer first: what a thread of a device does.
#pragma once

#include "dual/dual.h"
#include "dual/ray_box_body.h"
#include "intersect/facing_body.h"
#include "intersect/triangle_body.h"
#include "object/linear_tree_body.h"

namespace raysheaf {

/// What a ray does on its way, counted.
struct WalkCounts {
  std::uint32_t box_tests = 0, triangle_tests = 0;
  std::uint32_t leaves = 0;  ///< visited; counted on the host alone, for src/lab/walk_counts.h
};

/// Calls `take(hit)` for the hits of a ray with the triangles of a leaf; returns the place after
/// them. `setup` has where hits count, which `take` may bring nearer.
template <class Take>
RAYSHEAF_HD std::uint32_t meet_leaf(const LinearTreeView& tree, std::uint32_t place, Facing facing,
                                    const RaySetup& setup, WalkCounts* counts, const Take& take) {
#ifndef __CUDA_ARCH__
  ++counts->leaves;
#endif
  for (bool more = true; more; ++place) {
    const LinearTriangle triangle = tree.triangles[place];
    more = triangle.ends_leaf == 0;
    ++counts->triangle_tests;
    TriangleHit hit;
    if (!intersect_triangle(setup, triangle.a, triangle.b, triangle.c, &hit)) continue;
    if (!shows(facing, static_cast<std::uint8_t>(triangle.flags), hit.front)) continue;
    take(EngineHit{hit.t, hit.u, hit.v, triangle.id});
  }
  return place;
}

/// Calls `leaf(place)` for the leaves whose boxes the ray meets, the nearer child of a node first.
/// `leaf` may bring the ray's end nearer, and returns the place after its last triangle.
template <class Leaf>
RAYSHEAF_HD void walk_tree(const LinearTreeView& tree, BoxRay* ray, WalkCounts* counts,
                           const Leaf& leaf) {
  if (tree.count <= kLinearLeaf || !ray->bounded) {
    for (std::uint32_t place = 0; place < tree.count;) place = leaf(place);
    return;
  }
  std::uint32_t waiting[kLinearDepth];
  float nears[kLinearDepth];
  std::uint32_t top = 0, next = 0;
  for (;;) {
    bool on = false;
    if ((next & kLeafBit) != 0) {
      leaf(next & ~kLeafBit);
    } else {
      const LinearNode& node = tree.nodes[next];
      float near[2];
      const bool meets_0 = enters(*ray, node.box[0], &near[0]);
      const bool meets_1 = enters(*ray, node.box[1], &near[1]);
      counts->box_tests += 2;
      on = meets_0 || meets_1;
      const std::uint32_t nearer = meets_0 && !(meets_1 && near[1] < near[0]) ? 0 : 1;
      if (meets_0 && meets_1) {
        waiting[top] = node.child[1 - nearer];
        nears[top++] = near[1 - nearer];
      }
      if (on) next = node.child[nearer];
    }
    while (!on) {
      if (top == 0) return;
      next = waiting[--top];
      on = nears[top] <= ray->s_far;
    }
  }
}

/// The hit of least (t, triangle).
RAYSHEAF_HD inline EngineHit closest_in_tree(const LinearTreeView& tree, const Box& scene,
                                             const Ray& ray, Facing facing, WalkCounts* counts) {
  EngineHit best;
  RaySetup setup = make_ray_setup(ray);
  BoxRay boxes = make_box_ray(ray, scene);
  walk_tree(tree, &boxes, counts, [&](std::uint32_t place) {
    return meet_leaf(tree, place, facing, setup, counts, [&](const EngineHit& hit) {
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
    return meet_leaf(tree, place, facing, setup, counts, [&](const EngineHit&) {
      met = true;
      setup.t_max = -1;
      boxes.s_far = -std::numeric_limits<float>::infinity();
    });
  });
  return met;
}

/// Calls `take(hit)` for every hit, in no order.
template <class Take>
RAYSHEAF_HD void all_in_tree(const LinearTreeView& tree, const Box& scene, const Ray& ray,
                             Facing facing, WalkCounts* counts, const Take& take) {
  const RaySetup setup = make_ray_setup(ray);
  BoxRay boxes = make_box_ray(ray, scene);
  walk_tree(tree, &boxes, counts, [&](std::uint32_t place) {
    return meet_leaf(tree, place, facing, setup, counts, take);
  });
}

/// Whether a stands before b in a row.
RAYSHEAF_HD inline bool stands_before(const EngineHit& a, const EngineHit& b) {
  return a.t < b.t || (a.t == b.t && a.triangle < b.triangle);
}

/// Sorts a ray's hits in place: a heap (J. W. J. Williams, "Algorithm 232: Heapsort", 1964), so
/// that a long row takes O(n log n) and no memory.
RAYSHEAF_HD inline void sort_row(EngineHit* hits, std::uint64_t count) {
  const auto sink = [&](std::uint64_t at, std::uint64_t end) {
    const EngineHit hit = hits[at];
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
    const EngineHit last = hits[end];
    hits[end] = hits[0];
    hits[0] = last;
    sink(0, end);
  }
}

}  // namespace raysheaf
