// Compiled once a SIMD target and chosen at run time (Google Highway). The operations and their
// order are those of `intersect_triangle`; lanes that it would settle in binary64 are handed to it.
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

/// The scalar test, for one triangle.
HWY_INLINE void intersect_one(const RaySetup& ray, const TriangleArrays& a, std::uint32_t i,
                              Facing facing, RayHit* best) {
  TriangleHit hit;
  if (!intersect_triangle(ray, corner(a, 0, i), corner(a, 1, i), corner(a, 2, i), &hit)) return;
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

HWY_INLINE V spread(const CornerLanes& p, const CornerLanes& q) {
  return hn::Add(hn::Abs(hn::Mul(p.x, q.y)), hn::Abs(hn::Mul(p.y, q.x)));
}

/// Lanes that may be hits: settled ones that are, and those that only the scalar test can settle.
HWY_INLINE M candidates(const RayLanes& r, const TriangleArrays& a, const RaySetup& ray,
                        std::uint32_t i) {
  using hn::Add, hn::And, hn::AndNot, hn::Div, hn::Ge, hn::Le, hn::Mul, hn::Or;
  const Floats d;
  const int x = ray.axis_x, y = ray.axis_y, z = ray.axis_z;
  const CornerLanes pa = load_corner(r, a.vertex[0][x] + i, a.vertex[0][y] + i, a.vertex[0][z] + i);
  const CornerLanes pb = load_corner(r, a.vertex[1][x] + i, a.vertex[1][y] + i, a.vertex[1][z] + i);
  const CornerLanes pc = load_corner(r, a.vertex[2][x] + i, a.vertex[2][y] + i, a.vertex[2][z] + i);
  const V u = edge(pc, pb), v = edge(pa, pc), w = edge(pb, pa);
  const V zero = hn::Zero(d);
  const M negative = Or(Or(hn::Lt(u, zero), hn::Lt(v, zero)), hn::Lt(w, zero));
  const M positive = Or(Or(hn::Gt(u, zero), hn::Gt(v, zero)), hn::Gt(w, zero));
  const M agree = hn::Not(And(negative, positive));
  if (hn::AllFalse(d, agree)) return agree;
  const V det = Add(Add(u, v), w);
  const V size = hn::Abs(det);
  const M nonzero = And(And(hn::Ne(u, zero), hn::Ne(v, zero)), hn::Ne(w, zero));
  const M normal =
      And(Ge(size, hn::Set(d, kSmallDeterminant)), Le(size, hn::Set(d, kLargeDeterminant)));
  const V products = Add(Add(spread(pc, pb), spread(pa, pc)), spread(pb, pa));
  const M well_seen = Le(products, Mul(hn::Set(d, kLargestSpread), size));
  const V distance =
      Add(Add(Mul(u, Mul(r.sz, pa.z)), Mul(v, Mul(r.sz, pb.z))), Mul(w, Mul(r.sz, pc.z)));
  const V reach = hn::Abs(distance);
  const M in_range =
      And(Ge(reach, hn::Set(d, kSmallDistance)), Le(reach, hn::Set(d, kLargeDeterminant)));
  const M settled = And(And(nonzero, normal), And(well_seen, in_range));
  const V t = Div(distance, det);
  const M inside = And(Ge(t, r.t_min), Le(t, r.t_max));
  return And(agree, Or(inside, hn::Not(settled)));
}

void IntersectList(const RaySetup& ray, const TriangleArrays& a, Facing facing, RayHit* best) {
  const Floats d;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  const RayLanes r(ray);
  std::uint32_t i = 0;
  for (; i + lanes <= a.count; i += lanes) {
    const M mask = candidates(r, a, ray, i);
    if (HWY_LIKELY(hn::AllFalse(d, mask))) continue;
    alignas(8) std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    std::uint64_t bits = 0;
    hwy::CopyBytes<8>(bytes, &bits);
    for (; bits != 0; bits &= bits - 1)
      intersect_one(ray, a, i + static_cast<std::uint32_t>(__builtin_ctzll(bits)), facing, best);
  }
  for (; i < a.count; ++i) intersect_one(ray, a, i, facing, best);
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
