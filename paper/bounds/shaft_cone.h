// The intersection of a shaft and a finite cone. The shaft is narrow if the rays' origins and ends
// are near each other, the cone if their directions are.
#pragma once

#include "geom/shaft.h"
#include "paper/bounds/finite_cone.h"

namespace raysheaf {

struct ShaftCone {
  Shaft shaft;
  FiniteCone cone;
};
static_assert(sizeof(ShaftCone) == 84);

RAYSHEAF_HD inline void bound_rays(View<const Ray> rays, const Box& scene, ShaftCone* bound) {
  bound_rays(rays, scene, &bound->shaft);
  bound_rays(rays, scene, &bound->cone);
}

RAYSHEAF_HD inline void bound_children(View<const ShaftCone> children, ShaftCone* bound) {
  bound->shaft = {};
  bound->cone.reach = 0;
  bound->cone.rays = bound_some(children, [](const ShaftCone& child) { return child.cone.rays; });
  for (const ShaftCone& child : children) {
    bound->shaft.origins = box_union(bound->shaft.origins, child.shaft.origins);
    bound->shaft.ends = box_union(bound->shaft.ends, child.shaft.ends);
    bound->cone.reach = std::fmax(bound->cone.reach, child.cone.reach);
  }
}

}  // namespace raysheaf
