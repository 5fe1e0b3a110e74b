// Every device function of base/ and geom/, on random input.
#pragma once

#include "base/float.h"
#include "base/view.h"
#include "cuda/words.h"
#include "geom/rounding.h"
#include "geom/sphere.h"
#include "paper/bounds/cone.h"
#include "paper/bounds/ray_bound.h"

namespace raysheaf::test {

struct VectorCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const float scale = draws.scale();
    const Vec3 a = draws.in_box(2) * scale, b = draws.in_box(2);
    const float s = draws.between(0.1f, 3);
    Vec3 c = a * b - s * a + b / s;
    c += -a;
    c *= s;
    out.put(c, a == b, dot(a, b), cross(a, b), length(a), normalized(a), lerp(a, b, s), abs(a));
    out.put(min(a, b), max(a, b), min_component(a), max_component(a), component(a, 1));
    out.put(clamp(s, 1, 2), luminance(abs(a)), is_finite(a), Vec2{a.x, b.x} + Vec2{a.y, b.y} * s);
  }
};

struct AffineCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const Affine outer = draws.map(), inner = draws.map();
    const Vec3 p = draws.in_box(3);
    out.put(transform_vector(outer, p), transform_point(outer, p), transform_normal(outer, p));
    out.put(column(outer, 3), mirrors(outer) ? 1.0f : 0.0f, compose(outer, inner));
  }
};

struct BitsCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const std::uint32_t x = draws.bits(), y = draws.bits(), z = draws.bits();
    out.put(float_bits(bits_float(x & 0x7f7fffffu)), div_ceil(x, (y >> 8) + 1), bits_for(x));
    out.put(gamma(static_cast<int>(x & 63)));
    out.put(leading_zeros(1 + (std::uint64_t{x} << (y & 31))), trailing_zeros(z | 0x800000u));
    const std::uint32_t row[4] = {x, y, z, 1};
    const View<const std::uint32_t> view(row, 4), middle = view.slice(1, 2);
    out.put(view[3], middle.empty(), middle[0]);
    out.put(*middle.begin(), middle.end() - middle.begin() == 2);
  }
};

struct RoundingCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const double first = draws.scale(), second = draws.scale();
    const double coarse = draws.between(-2, 2), fine = draws.unit() * 0x1p-30;
    const double x = (coarse + fine) * (first * second);
    out.put(rounded(x), rounded_up(x));
  }
};

struct SphereCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const float scale = draws.scale();
    const Vec3 a = draws.in_box(4) * scale, b = draws.in_box(4) * scale;
    const Vec3 c = draws.below(4) == 0 ? lerp(a, b, 0.5f) : draws.in_box(4) * scale;
    const Sphere first = triangle_sphere(a, b, c);
    const Sphere second{draws.in_box(8) * scale, draws.between(-0.2f, 8) * scale};
    const Sphere both = sphere_union(first, second);
    out.put(first.center, first.radius, both.center, both.radius, radius_grown(scale));
  }
};

RAYSHEAF_HD inline Cone random_cone(Draws& draws) {
  const Vec3 axis = draws.direction();
  const float sine = draws.unit();
  return {axis, draws.below(16) == 0 ? 2 : sine * sine};
}

struct ConeCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const Cone a = random_cone(draws), b = random_cone(draws);
    const Vec3 r = draws.direction();
    const GrowingCone grown = extended({a.axis, cosine_of_sine(a.sin_angle), a.sin_angle}, r);
    out.put(grown.axis, grown.cos_angle, grown.sin_angle, farthest_sine(r, a), union_axis(a, b));
    out.put(sine_grown(a.sin_angle), a.whole());
  }
};

RAYSHEAF_HD inline RayBound random_ray_bound(Draws& draws) {
  Ray rays[4];
  const Vec3 center = draws.in_box(5), axis = draws.direction();
  const float extent = draws.unit(), spread = draws.unit();
  for (Ray& ray : rays) {
    ray.origin = center + draws.in_box(extent * extent);
    ray.direction = axis + draws.in_box(spread * spread);
  }
  return bound_rays(View<const Ray>(rays, 4));
}

RAYSHEAF_HD inline void put_bound(Words& out, const RayBound& bound) {
  out.put(bound.origins.center, bound.origins.radius, bound.directions.axis,
          bound.directions.sin_angle);
}

struct RayBoundCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const RayBound children[2] = {random_ray_bound(draws), random_ray_bound(draws)};
    put_bound(out, children[0]);
    put_bound(out, bound_children(View<const RayBound>(children, 2)));
  }
};

}  // namespace raysheaf::test
