// Every bound of a ray bundle and its intersection test, on random input.
#pragma once

#include "cuda/key_cases.h"
#include "paper/bounds/bounds.h"
#include "paper/ray_hierarchy/node_test.h"

namespace raysheaf::test {

struct RandomBundle {
  Ray rays[4];

  RAYSHEAF_HD explicit RandomBundle(Draws& draws) {
    const Vec3 center = draws.in_box(5), axis = draws.direction();
    const float extent = draws.unit(), spread = draws.unit();
    for (Ray& ray : rays) {
      ray.origin = center + draws.in_box(extent * extent);
      ray.direction = axis + draws.in_box(spread * spread);
      if (draws.below(2) == 0) ray.t_max = draws.between(0, 9);
    }
  }
  [[nodiscard]] RAYSHEAF_HD View<const Ray> view() const { return {rays, 4}; }
};

/// Tests a triangle as the traversal does: by its bounding sphere, its box, or both.
RAYSHEAF_HD inline bool meets_triangle(const ConeSphereTest& test, Vec3 a, Vec3 b, Vec3 c) {
  const Sphere ball = triangle_sphere(a, b, c);
  return meets(test, ball.center, ball.radius);
}
RAYSHEAF_HD inline bool meets_triangle(const FiniteConeTest& test, Vec3 a, Vec3 b, Vec3 c) {
  const Sphere ball = triangle_sphere(a, b, c);
  return meets(test, ball.center, ball.radius);
}
RAYSHEAF_HD inline bool meets_triangle(const BeamTest& test, Vec3 a, Vec3 b, Vec3 c) {
  return meets(test, box_of_triangle(a, b, c));
}
RAYSHEAF_HD inline bool meets_triangle(const FrustumTest& test, Vec3 a, Vec3 b, Vec3 c) {
  return meets(test, box_of_triangle(a, b, c));
}
RAYSHEAF_HD inline bool meets_triangle(const ShaftConeTest& test, Vec3 a, Vec3 b, Vec3 c) {
  return meets_triangle(test.shaft, a, b, c) && meets_triangle(test.cone, a, b, c);
}

RAYSHEAF_HD inline void put_of(Words& out, const Box& box) {
  out.put(box.min, box.max);
}
RAYSHEAF_HD inline void put_of(Words& out, const RayBound& bound) {
  out.put(bound.origins.center, bound.origins.radius, bound.directions.axis,
          bound.directions.sin_angle);
}
RAYSHEAF_HD inline void put_of(Words& out, const FiniteCone& bound) {
  put_of(out, bound.rays);
  out.put(bound.reach);
}
RAYSHEAF_HD inline void put_of(Words& out, const Shaft& bound) {
  put_of(out, bound.origins);
  put_of(out, bound.ends);
}
RAYSHEAF_HD inline void put_of(Words& out, const Frustum& bound) {
  put_of(out, bound.origins);
  put_of(out, bound.directions);
  put_of(out, bound.hull);
  out.put(bound.reach);
}
RAYSHEAF_HD inline void put_of(Words& out, const ShaftCone& bound) {
  put_of(out, bound.shaft);
  put_of(out, bound.cone);
}

/// Bounds two bundles, then both together; the triangles are near the rays of the first.
template <class Bound>
struct BoundCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const Box scene = random_box(draws);
    Bound children[2], both;
    const RandomBundle first(draws), second(draws);
    bound_rays(first.view(), scene, &children[0]);
    bound_rays(second.view(), scene, &children[1]);
    bound_children(View<const Bound>(children, 2), &both);
    put_of(out, both);
    const auto test = make_node_test(both), child_test = make_node_test(children[0]);
    for (int i = 0; i < 6; ++i) {
      const Vec3 on_ray = first.rays[0].origin + first.rays[0].direction * draws.between(-1, 6);
      const Vec3 a = on_ray + draws.in_box(2), b = a + draws.in_box(1), c = a + draws.in_box(1);
      out.put(meets_triangle(test, a, b, c), meets_triangle(child_test, a, b, c));
    }
  }
};

struct BoundPartsCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const Ray ray = random_ray(draws);
    const Box scene = random_box(draws), end = end_of(ray, scene);
    put_of(out, end);
    put_of(out, box_union(end, scene));
    float enter = 0, exit = draws.between(0, 9);
    clip_to_slab(draws.between(-2, 0), 1, ray.direction.x, &enter, &exit);
    out.put(farthest(end, ray.origin), enter, exit);
    const BeamTest beam = make_beam_test(scene, ray.direction, ray.direction * 2);
    out.put(beam.per_min, beam.per_max, reciprocal_of_speed(ray.direction.x));
    float lo = 0, hi = 1;
    clip(draws.between(-1, 1), beam.per_min.x, &lo, &hi);
    out.put(lo, hi, beam_slack(abs(end.min), abs(scene.max)));
    const auto itself = [](const RayBound& bound) { return bound; };
    const RayBound bounds[2] = {bound_rays(RandomBundle(draws).view()), {}};
    put_of(out, bound_some(View<const RayBound>(bounds, 2), itself));
  }
};

}  // namespace raysheaf::test
