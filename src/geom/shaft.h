// The convex hull of a box of origins and a box of ends:
// { (1 - t) o + t e : o in O, e in E, 0 <= t <= 1 }.
//
//        +-----------------------+
//     +--+                       |      For a fixed t this is a box between O and E, so the shaft
//     |O |                       E      is the volume that one moving box sweeps (E. Haines,
//     +--+                       |      J. Wallace, "Shaft Culling for Efficient Ray-Traced
//        +-----------------------+      Radiosity", 1994, describe it by planes).
//
// Unions are exact, and a child's shaft is contained in its parent's.
#pragma once

#include "base/view.h"
#include "geom/ray_end.h"

namespace raysheaf {

struct Shaft {
  Box origins, ends;
};
static_assert(sizeof(Shaft) == 48);

RAYSHEAF_HD inline void bound_rays(View<const Ray> rays, const Box& scene, Shaft* bound) {
  *bound = {};
  for (const Ray& ray : rays) {
    bound->origins = box_union(bound->origins, {ray.origin, ray.origin});
    bound->ends = box_union(bound->ends, end_of(ray, scene));
  }
}

RAYSHEAF_HD inline void bound_children(View<const Shaft> children, Shaft* bound) {
  *bound = {};
  for (const Shaft& child : children) {
    bound->origins = box_union(bound->origins, child.origins);
    bound->ends = box_union(bound->ends, child.ends);
  }
}

}  // namespace raysheaf
