// Compiled once for each SIMD target and chosen at run time (Google Highway). Stage 1 of the
// ray-triangle test (intersect/triangle_body.h) for one ray with as many triangles as a vector has
// lanes; triangles that it does not reject go to stage 2.
#include "intersect/facing_body.h"
#include "intersect/intersect_list.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "intersect/intersect_list_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
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

struct CornerLanes {
  V x, y, z;
};

HWY_INLINE CornerLanes load_corner(const RayLanes& r, const float* x, const float* y,
                                   const float* z) {
  using hn::LoadU, hn::Mul, hn::Sub;
  const Floats d;
  const V along = Sub(LoadU(d, z), r.oz);
  return {Sub(Sub(LoadU(d, x), r.ox), Mul(r.sx, along)),
          Sub(Sub(LoadU(d, y), r.oy), Mul(r.sy, along)), along};
}

HWY_INLINE V edge(const CornerLanes& p, const CornerLanes& q) {
  return hn::Sub(hn::Mul(p.x, q.y), hn::Mul(p.y, q.x));
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
  const M usual =
      hn::And(hn::Ge(extent, hn::Set(d, 0x1p-60f)), hn::Le(extent, hn::Set(d, 0x1p60f)));
  return hn::IfThenElse(usual, hn::Mul(extent, hn::Set(d, 2 + 8 * 0x1p-24f)),
                        hn::Set(d, std::numeric_limits<float>::infinity()));
}

/// Lanes that stage 1 does not reject, without those that are certainly farther than `nearest`.
HWY_INLINE M candidates(const RayLanes& r, const TriangleArrays& a, const RaySetup& ray,
                        std::uint32_t i, float nearest) {
  using hn::Abs, hn::Add, hn::Gt, hn::Lt, hn::Max, hn::Min, hn::Mul, hn::Neg;
  const Floats d;
  const auto all = [&](float x) { return hn::Set(d, x); };
  const int x = ray.axis_x, y = ray.axis_y, z = ray.axis_z;
  const CornerLanes pa = load_corner(r, a.vertex[0][x] + i, a.vertex[0][y] + i, a.vertex[0][z] + i);
  const CornerLanes pb = load_corner(r, a.vertex[1][x] + i, a.vertex[1][y] + i, a.vertex[1][z] + i);
  const CornerLanes pc = load_corner(r, a.vertex[2][x] + i, a.vertex[2][y] + i, a.vertex[2][z] + i);
  const V u = edge(pc, pb), v = edge(pa, pc), w = edge(pb, pa);
  const V reach = reach_of_lanes(a, i), extent = Add(Abs(pa.z), reach);
  const V error =
      Mul(extent, Add(Mul(all(kErrorOfSquare), extent), Mul(all(kErrorOfReach), reach)));
  const V least = Min(Min(u, v), w), most = Max(Max(u, v), w);
  const M possible = hn::Not(Gt(Min(Neg(least), most), error));
  if (HWY_LIKELY(hn::AllFalse(d, possible))) return possible;
  // The depth of a hit differs from a corner's by at most the triangle's extent. Rounding errors
  // are 4 u of either.
  const V depth = Mul(r.sz, pa.z), room = Mul(Abs(r.sz), extent);
  const V reached = Add(room, Mul(all(0x1p-20f), Add(Abs(depth), all(0x1p-120f))));
  const M beyond = hn::Or(Lt(Add(depth, reached), r.t_min),
                          Gt(hn::Sub(depth, reached), Min(r.t_max, all(nearest))));
  return hn::AndNot(beyond, possible);
}

void IntersectList(const RaySetup& ray, const TriangleArrays& a, Facing facing, RayHit* best) {
  const Floats d;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  const RayLanes r(ray);
  std::uint32_t i = 0;
  for (; i + lanes <= a.count; i += lanes) {
    const M mask = candidates(r, a, ray, i, best->t);
    if (HWY_LIKELY(hn::AllFalse(d, mask))) continue;
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    std::uint64_t bits = 0;
    hwy::CopyBytes<8>(bytes, &bits);
    for (; bits != 0; bits &= bits - 1)
      intersect_one(ray, a, i + static_cast<std::uint32_t>(__builtin_ctzll(bits)), facing, best);
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
