// Compiled once for each SIMD target and chosen at run time (Google Highway). Stage 1 of the
// ray-triangle test (intersect/triangle_body.h) for one ray with as many triangles as a vector has
// lanes; triangles that it does not reject go to stage 2.
#include "intersect/facing_body.h"
#include "intersect/intersect_list.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "intersect/intersect_list_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/lanes-inl.h"
#include "intersect/edges-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using V = hn::Vec<Floats>;
using M = hn::Mask<Floats>;

inline Vec3 corner(const TriangleArrays& a, int k, std::uint32_t i) {
  return {a.vertex[k][0][i], a.vertex[k][1][i], a.vertex[k][2][i]};
}

/// Stages 2 and 3, for one triangle.
HWY_INLINE void intersect_one(const RaySetup& ray, const TriangleArrays& a, std::uint32_t i,
                              Facing facing, RayHit* best) {
  TriangleHit hit;
  if (!line_meets_triangle(ray.origin, ray.direction, corner(a, 0, i), corner(a, 1, i),
                           corner(a, 2, i), &hit) ||
      !is_within(hit.t, ray.t_min, ray.t_max))
    return;
  const std::uint32_t id = a.ids != nullptr ? a.ids[i] : a.first_id + i;
  if (facing != Facing::kBoth && !shows(facing, a.flags[id], hit.front)) return;
  best->take(hit.t, id);
}

struct RayLanes {
  explicit RayLanes(const RaySetup& r)
      : ox(Set(component(r.origin, r.axis_x))),
        oy(Set(component(r.origin, r.axis_y))),
        oz(Set(component(r.origin, r.axis_z))),
        sx(Set(r.shear_x)),
        sy(Set(r.shear_y)),
        sz(Set(r.shear_z)),
        t_min(Set(r.t_min)),
        t_max(Set(r.t_max)) {}
  static V Set(float x) { return hn::Set(Floats(), x); }
  V ox, oy, oz, sx, sy, sz, t_min, t_max;
};

HWY_INLINE Corner<Floats> load_corner(const RayLanes& r, const RaySetup& ray,
                                      const float* const (&vertex)[3], std::uint32_t i) {
  const auto from = [&](int axis, V origin)
                        HWY_ATTR { return hn::Sub(hn::LoadU(Floats(), vertex[axis] + i), origin); };
  return sheared(Floats(), from(ray.axis_x, r.ox), from(ray.axis_y, r.oy), from(ray.axis_z, r.oz),
                 r.sx, r.sy);
}

/// SIMD version of `reach_of`.
HWY_INLINE V reach_of_lanes(const TriangleArrays& a, std::uint32_t i) {
  const Floats d;
  V extent = hn::Zero(d);
  for (int axis = 0; axis < 3; ++axis) {
    const V p = hn::LoadU(d, a.vertex[0][axis] + i), q = hn::LoadU(d, a.vertex[1][axis] + i);
    const V r = hn::LoadU(d, a.vertex[2][axis] + i);
    const V high = hn::Max(hn::Max(p, q), r), low = hn::Min(hn::Min(p, q), r);
    extent = hn::Max(extent, hn::Sub(high, low));
  }
  const M usual = hn::And(hn::Ge(extent, hn::Set(d, kLeastReachExtent)),
                          hn::Le(extent, hn::Set(d, kMostReachExtent)));
  return hn::IfThenElse(usual, hn::Mul(extent, hn::Set(d, kReachOfExtent)),
                        hn::Set(d, std::numeric_limits<float>::infinity()));
}

/// Lanes that stage 1 does not reject, without those that are certainly farther than `nearest`.
HWY_INLINE M candidates(const RayLanes& r, const TriangleArrays& a, const RaySetup& ray,
                        std::uint32_t i, float nearest) {
  using hn::Abs, hn::Add, hn::Gt, hn::Lt, hn::Min, hn::Mul;
  const Floats d;
  const auto all = [&](float x) HWY_ATTR { return hn::Set(d, x); };
  const auto corner = [&](int k) HWY_ATTR { return load_corner(r, ray, a.vertex[k], i); };
  const Corner<Floats> pa = corner(0);
  const Edges<Floats> edges = edges_of(d, pa, corner(1), corner(2), reach_of_lanes(a, i));
  if (HWY_LIKELY(hn::AllFalse(d, edges.possible))) return edges.possible;
  // The depth of a hit differs from a corner's by at most the triangle's extent. Rounding errors
  // are 4 u of either.
  const V depth = Mul(r.sz, pa.z), room = Mul(Abs(r.sz), edges.size);
  const V reached = Add(room, Mul(all(0x1p-20f), Add(Abs(depth), all(0x1p-120f))));
  const M beyond = hn::Or(Lt(Add(depth, reached), r.t_min),
                          Gt(hn::Sub(depth, reached), Min(r.t_max, all(nearest))));
  return hn::AndNot(beyond, edges.possible);
}

void IntersectList(const RaySetup& ray, const TriangleArrays& a, Facing facing, RayHit* best) {
  const Floats d;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  const RayLanes r(ray);
  std::uint32_t i = 0;
  for (; i + lanes <= a.count; i += lanes) {
    const M mask = candidates(r, a, ray, i, best->t);
    if (HWY_LIKELY(hn::AllFalse(d, mask))) continue;
    for (std::uint32_t bits = bits_of(d, mask); bits != 0; bits &= bits - 1)
      intersect_one(ray, a, i + static_cast<std::uint32_t>(__builtin_ctz(bits)), facing, best);
  }
  for (; i < a.count; ++i)
    if (!surely_misses(ray, corner(a, 0, i), corner(a, 1, i), corner(a, 2, i)))
      intersect_one(ray, a, i, facing, best);
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(IntersectList);

void intersect_list(const RaySetup& ray, const TriangleArrays& triangles, Facing facing,
                    RayHit* best) {
  HWY_DYNAMIC_DISPATCH(IntersectList)(ray, triangles, facing, best);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
