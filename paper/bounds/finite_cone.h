// The paper's bound with a finite length: every hit of the bundle's rays lies within `reach` of its
// ray's origin.
#pragma once

#include "geom/ray_end.h"
#include "paper/bounds/ray_bound.h"

namespace raysheaf {

struct FiniteCone {
  RayBound rays;
  float reach = 0;
};
static_assert(sizeof(FiniteCone) == 36);

RAYSHEAF_HD inline void bound_rays(View<const Ray> rays, const Box& scene, FiniteCone* bound) {
  bound->rays = bound_rays(rays);
  bound->reach = 0;
  for (const Ray& ray : rays) {
    const float reach = radius_grown(length(farthest(end_of(ray, scene), ray.origin)));
    bound->reach = std::fmax(bound->reach, reach);
  }
}

RAYSHEAF_HD inline void bound_children(View<const FiniteCone> children, FiniteCone* bound) {
  bound->rays = bound_some(children, [](const FiniteCone& child) { return child.rays; });
  bound->reach = 0;
  for (const FiniteCone& child : children) bound->reach = std::fmax(bound->reach, child.reach);
}

}  // namespace raysheaf
