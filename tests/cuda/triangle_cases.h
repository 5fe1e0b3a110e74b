// The ray-triangle test, stage by stage.
#pragma once

#include "cuda/words.h"
#include "intersect/facing_body.h"
#include "intersect/float_answer_body.h"
#include "intersect/intersect_list.h"
#include "intersect/triangle_body.h"

namespace raysheaf::test {

/// Integers of five words, made from floats of all magnitudes and of one.
struct WideCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const float first = draws.scale(), second = draws.scale();
    const Vec3 a = draws.in_box(2) * first, b = draws.in_box(2);
    const Vec3 c = draws.below(2) == 0 ? a : draws.in_box(2) * second;
    BitSpan span;
    span.include(a);
    span.include(b);
    span.include(c.x);
    out.put(static_cast<std::uint32_t>(span.low - span.high), span.bits() > 40,
            are_in_line(a, b, c), are_in_line(a, b, b));
    const WideVector<5> p = to_wide<5>(a, -149), q = to_wide<5>(b, -149);
    const auto across = cross(p, q - p);
    const auto det = dot(across, q) + dot(across, p);
    out.put(det.sign() == 0, det.is_negative(), to_double(dot(across, to_wide<5>(c, -149))));
    const WideAnswer answer = answer_in_words<5>({}, b, a, c, b, -149, -149);
    out.put(answer.meets, answer.t, answer.u, answer.v, answer.front);
  }
};

/// Rays are aimed at the triangle, a third of them at an edge, so that all stages of the test run.
struct TriangleCase {
  RAYSHEAF_HD void operator()(Draws& draws, Words& out) const {
    const float scale = draws.scale();
    const Vec3 a = draws.in_box(2) * scale, b = draws.in_box(2) * scale;
    const Vec3 c = draws.in_box(2) * scale;
    const float u = draws.below(3) == 0 ? 0 : draws.unit();
    const Vec3 target = lerp(a, b, draws.unit()) * (1 - u) + c * u;
    const Vec3 origin = draws.in_box(3) * scale;
    const RaySetup ray = make_ray_setup({origin, 0, target - origin});
    TriangleHit hit{}, exact{};
    const WideAnswer wide = answer_in_integers(origin, target - origin, a, b, c);
    out.put(intersect_triangle(ray, a, b, c, &hit), surely_misses(ray, a, b, c),
            line_meets_triangle(origin, target - origin, a, b, c, &exact), wide.meets);
    out.put(hit.t, hit.u, hit.v, hit.front, exact.t, exact.u, exact.v, exact.front);
    const Determinants x = determinants(origin, target - origin, a, b, c);
    out.put(x.det, x.t, x.u, x.v, x.det_error, x.t_error, x.give_values(), x.are_finite());
    const auto parts = DifferenceParts(origin.x, a.y);
    out.put(parts.high, parts.low);
    TriangleHit doubled{};
    const LineAnswer said = answer_in_doubles(origin, target - origin, a, b, c, &doubled);
    out.put(static_cast<std::uint32_t>(said), doubled.t, doubled.u);
    const TriangleHit again = values_of_hit(origin, target - origin, a, b, c);
    const TriangleHit behind = rounded_hit(-1e-60, x.u, 2, true);
    out.put(again.t, again.u, behind.t, behind.u, behind.v, is_within(again.t, 0, 1));
    out.put(reach_of(a, b, c), reach_of_extent(scale), wide.t, wide.u, wide.v, wide.front);
    out.put(shows(Facing::kSkipBackOfSingleSided, kSingleSided, hit.front));
    const Edges edges = edges_of(ray, a, b, c);
    const FloatAnswer floats = answer_in_floats(ray, a, b, c);
    out.put(edges.surely_miss(), edges.surely_hit(), floats.low, floats.high, floats.front,
            static_cast<std::uint32_t>(floats.kind));
    RayHit best;
    best.take(hit.t, 3);
    best.take(exact.t, 2);
    out.put(best.found(), best.t, best.triangle);
  }
};

}  // namespace raysheaf::test
