// A frustum: a box of origins, intervals of slopes by which it spreads, a reach that ends it, and
// the box that contains all of it.
//
//          /|       Directions are scaled so that their largest component is 1. If all rays of a
//     +--+/ |       bundle have one dominant axis, that component's interval is a point, and the
//     |O |  |       other two span four planes (J. Arvo, D. Kirk, "Fast Ray Tracing by Ray
//     +--+\ |       Classification", SIGGRAPH 1987; K. Garanzha, C. Loop, "Fast Ray Sorting and
//          \|       Breadth-First Packet Traversal", 2010). Otherwise the three intervals bound
//                   the bundle less tightly.
#pragma once

#include "base/view.h"
#include "geom/ray_end.h"

namespace raysheaf {

struct Frustum {
  Box origins, directions, hull;
  float reach = 0;  ///< largest parameter, in scaled directions
};
static_assert(sizeof(Frustum) == 76);

/// Each scaled direction has one rounding error, which is accounted for at the hit's position.
RAYSHEAF_HD inline void bound_rays(View<const Ray> rays, const Box& scene, Frustum* bound) {
  *bound = {};
  for (const Ray& ray : rays) {
    const Box origin{ray.origin, ray.origin}, end = end_of(ray, scene);
    const float largest = max_component(abs(ray.direction));
    const Vec3 direction = largest > 0 ? ray.direction / largest : Vec3{};
    bound->origins = box_union(bound->origins, origin);
    bound->directions = box_union(bound->directions, {direction, direction});
    bound->hull = box_union(bound->hull, box_union(origin, end));
    bound->reach = std::fmax(bound->reach, max_component(farthest(end, ray.origin)));
  }
}

RAYSHEAF_HD inline void bound_children(View<const Frustum> children, Frustum* bound) {
  *bound = {};
  for (const Frustum& child : children) {
    bound->origins = box_union(bound->origins, child.origins);
    bound->directions = box_union(bound->directions, child.directions);
    bound->hull = box_union(bound->hull, child.hull);
    bound->reach = std::fmax(bound->reach, child.reach);
  }
}

}  // namespace raysheaf
