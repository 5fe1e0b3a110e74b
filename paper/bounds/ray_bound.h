// The paper's bound of a bundle of rays: a sphere around the origins and a cone around the
// directions, eight floats.
//
//          \        /
//           \  .   /      { o + t d : |o - center| <= radius,
//     ( c )--->axis                   angle(d, axis) <= angle, t >= 0 }
//           /      \      .
#pragma once

#include "base/view.h"
#include "geom/sphere.h"
#include "paper/bounds/cone.h"

namespace raysheaf {

struct RayBound {
  Sphere origins;
  Cone directions;
};
static_assert(sizeof(RayBound) == 32);

/// Bounds rays: Szecsi's cone determines the axis, then the angle is measured from it, so that
/// rounding errors of the axis cannot exclude a direction. O(rays).
RAYSHEAF_HD inline RayBound bound_rays(View<const Ray> rays) {
  RayBound bound;
  GrowingCone cone{normalized(rays[0].direction)};
  for (const Ray& ray : rays) {
    bound.origins = sphere_union(bound.origins, {ray.origin, 0});
    cone = extended(cone, normalized(ray.direction));
  }
  const Vec3 axis = cone.axis;
  float sine = 0, reach = 0;
  for (const Ray& ray : rays) {
    const Vec3 direction = normalized(ray.direction);
    if (!(dot(axis, direction) > gamma(16))) sine = 2;
    sine = std::fmax(sine, length(cross(axis, direction)));
    reach = std::fmax(reach, length(ray.origin - bound.origins.center));
  }
  bound.origins.radius = radius_grown(reach);
  bound.directions = {axis, sine_grown(sine)};
  return bound;
}

/// Bounds the bounds `of(item)`: unions determine the centre and the axis, then both extents are
/// measured.
template <class Item, class Of>
RAYSHEAF_HD RayBound bound_some(View<const Item> items, const Of& of) {
  RayBound bound = of(items[0]);
  float sine = 0, reach = 0;
  for (const Item& item : items) {
    const RayBound child = of(item);
    bound.origins = sphere_union(bound.origins, child.origins);
    const Vec3 axis = union_axis(bound.directions, child.directions);
    const float grown =
        std::fmax(farthest_sine(axis, bound.directions), farthest_sine(axis, child.directions));
    bound.directions = {axis, grown};
  }
  for (const Item& item : items) {
    const RayBound child = of(item);
    sine = std::fmax(sine, farthest_sine(bound.directions.axis, child.directions));
    reach = std::fmax(reach,
                      length(child.origins.center - bound.origins.center) + child.origins.radius);
  }
  bound.origins.radius = radius_grown(reach);
  bound.directions.sin_angle = sine_grown(sine);
  return bound;
}

RAYSHEAF_HD inline RayBound bound_children(View<const RayBound> children) {
  return bound_some(children, [](const RayBound& child) { return child; });
}

}  // namespace raysheaf
