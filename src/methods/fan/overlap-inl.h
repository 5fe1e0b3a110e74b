// Tests one triangle with the bounds of cells, SIMD over the cells. Included once for each SIMD
// target.
//
// Exact arithmetic defines a hit (intersect/triangle_body.h): with x, y, z a corner relative to the
// origin along the axes of the ray's face, and (s, r) the ray's slopes, the sheared corners X = x -
// s z, Y = y - r z form a triangle that contains the point (0, 0), including its edges. Here
// corners are rounded, and cells hold rounded slopes. Let u be the unit roundoff.
//
// Rectangle. Consequently some X is >= 0 and some X is <= 0. If every |z| is at least kSafeDepth
// and on the ray's side, s is at most the largest quotient x / z, except for u |s| <= u in the
// slope and 3 u |x / z| in the quotient, and for underflow. A quotient beyond 2 lies outside the
// face in any case. kRectanglePad, 8 u, is more.
//
// Depth. t is that of a point of the triangle, rounded once; therefore it is at least the nearest
// corner's, except for gamma(5) in the rounding, the depth and the reach. kDepthScale subtracts 16
// u.
//
// Edges. Let S bound |X| and |Y| over the cells, M the corners' coordinates; S <= 2 M, and R M <= S
// for cells that reach R from the point (s0, r0) around which the edges are written. Rounded
// corners and slopes move a sheared corner by 3 u M, and an edge function by 12 u M S. The
// evaluation here adds: 20 u M S for the value at (s0, r0), (2 M + 6 S) M R u for either slope (R
// <= 2) <= 14 u M S, 36 u M S for the sums. That is 96 u M S; kEdgeSlack is 128 u. A hit's three
// edge functions agree in sign, so no ray of a cell hits if one of them is beyond this on one side
// and another one on the other side, for every ray in the cell.
#if defined(RAYSHEAF_FAN_OVERLAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSHEAF_FAN_OVERLAP_INL_H_
#undef RAYSHEAF_FAN_OVERLAP_INL_H_
#else
#define RAYSHEAF_FAN_OVERLAP_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>
#include <cstring>

#include "base/float.h"
#include "methods/fan/cells.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kBundleSlots>;
using V = hn::Vec<Floats>;
using M = hn::Mask<Floats>;

constexpr float kSafeDepth = 0x1p-100f;
constexpr float kRectanglePad = 8 * kUnitRoundoff;
constexpr float kDepthScale = 1 - 16 * kUnitRoundoff;
constexpr float kEdgeSlack = 128 * kUnitRoundoff;
constexpr float kEdgeTiny = 0x1p-120f;

/// 16 triangles in columns, one lane each.
struct alignas(64) TriangleLanes {
  float corner[3][3][kBundleSlots];  ///< [corner][axis]: relative to the origin, in the face's axes
  float u0[kBundleSlots], u1[kBundleSlots], v0[kBundleSlots], v1[kBundleSlots];
  float depth[kBundleSlots];  ///< of the nearest corner; -infinity if not all corners are in front
                              ///< of the origin
  float edge[3][kBundleSlots], slope_u[3][kBundleSlots], slope_v[3][kBundleSlots];
  float slack[kBundleSlots];
};

HWY_INLINE V Min3(V a, V b, V c) {
  return hn::Min(hn::Min(a, b), c);
}
HWY_INLINE V Max3(V a, V b, V c) {
  return hn::Max(hn::Max(a, b), c);
}

/// The bits of a mask, lane 0 lowest.
HWY_INLINE std::uint32_t BitsOf(M mask) {
  const Floats d;
  alignas(8) std::uint8_t bytes[8];
  hn::StoreMaskBits(d, mask, bytes);
  if (hn::Lanes(d) <= 8) return bytes[0] & ((1u << hn::Lanes(d)) - 1);
  std::uint16_t bits;
  std::memcpy(&bits, bytes, sizeof bits);
  return bits;
}

/// Computes rectangles and depths of the lanes from `k`. `sign` is the face's.
HWY_INLINE void MakeRectangles(const V x[3], const V y[3], const V z[3], float sign, std::size_t k,
                               TriangleLanes* t) {
  const Floats d;
  const V infinity = hn::Set(d, std::numeric_limits<float>::infinity());
  const V side = hn::Set(d, sign), pad = hn::Set(d, kRectanglePad);
  const V nearest = Min3(hn::Mul(z[0], side), hn::Mul(z[1], side), hn::Mul(z[2], side));
  const M before = hn::Ge(nearest, hn::Set(d, kSafeDepth));
  const V ua = hn::Div(x[0], z[0]), ub = hn::Div(x[1], z[1]), uc = hn::Div(x[2], z[2]);
  const V va = hn::Div(y[0], z[0]), vb = hn::Div(y[1], z[1]), vc = hn::Div(y[2], z[2]);
  const auto from = [&](V v) { return hn::IfThenElse(before, v, hn::Neg(infinity)); };
  const auto to = [&](V v) { return hn::IfThenElse(before, v, infinity); };
  hn::Store(from(hn::Sub(Min3(ua, ub, uc), pad)), d, t->u0 + k);
  hn::Store(to(hn::Add(Max3(ua, ub, uc), pad)), d, t->u1 + k);
  hn::Store(from(hn::Sub(Min3(va, vb, vc), pad)), d, t->v0 + k);
  hn::Store(to(hn::Add(Max3(va, vb, vc), pad)), d, t->v1 + k);
  hn::Store(from(hn::Mul(nearest, hn::Set(d, kDepthScale))), d, t->depth + k);
}

/// Computes edge functions around (s0, r0), for cells within `radius` of it on either axis.
HWY_INLINE void MakeEdges(const V x[3], const V y[3], const V z[3], float s0, float r0,
                          float radius, std::size_t k, TriangleLanes* t) {
  const Floats d;
  V px[3], py[3];
  V sheared = hn::Zero(d), size = hn::Zero(d);
  for (int i = 0; i < 3; ++i) {
    px[i] = hn::Sub(x[i], hn::Mul(hn::Set(d, s0), z[i]));
    py[i] = hn::Sub(y[i], hn::Mul(hn::Set(d, r0), z[i]));
    sheared = Max3(sheared, hn::Abs(px[i]), hn::Abs(py[i]));
    size = hn::Max(size, Max3(hn::Abs(x[i]), hn::Abs(y[i]), hn::Abs(z[i])));
  }
  // U is the edge of corners c and b, V of a and c, W of b and a.
  constexpr int kFrom[3] = {2, 0, 1}, kTo[3] = {1, 2, 0};
  for (int e = 0; e < 3; ++e) {
    const int p = kFrom[e], q = kTo[e];
    hn::Store(hn::Sub(hn::Mul(px[p], py[q]), hn::Mul(py[p], px[q])), d, t->edge[e] + k);
    hn::Store(hn::Sub(hn::Mul(py[p], z[q]), hn::Mul(z[p], py[q])), d, t->slope_u[e] + k);
    hn::Store(hn::Sub(hn::Mul(z[p], px[q]), hn::Mul(px[p], z[q])), d, t->slope_v[e] + k);
  }
  const V within = hn::Add(sheared, hn::Mul(hn::Set(d, radius + 4 * kUnitRoundoff), size));
  hn::Store(hn::Add(hn::Mul(hn::Mul(within, size), hn::Set(d, kEdgeSlack)), hn::Set(d, kEdgeTiny)),
            d, t->slack + k);
}

/// Columns of bounds; `u0` to `v1` both as they are and relative to (s0, r0); the two may be the
/// same columns.
struct BoundColumns {
  const float *u0, *u1, *v0, *v1, *reach;
  const float *du0, *du1, *dv0, *dv1;
};

HWY_INLINE M RectanglesMeet(const BoundColumns& b, std::size_t i, const TriangleLanes& t,
                            std::uint32_t lane) {
  const Floats d;
  const M u = hn::And(hn::Le(hn::LoadU(d, b.u0 + i), hn::Set(d, t.u1[lane])),
                      hn::Ge(hn::LoadU(d, b.u1 + i), hn::Set(d, t.u0[lane])));
  const M v = hn::And(hn::Le(hn::LoadU(d, b.v0 + i), hn::Set(d, t.v1[lane])),
                      hn::Ge(hn::LoadU(d, b.v1 + i), hn::Set(d, t.v0[lane])));
  return hn::And(hn::And(u, v), hn::Ge(hn::LoadU(d, b.reach + i), hn::Set(d, t.depth[lane])));
}

HWY_INLINE M EdgesMeet(const BoundColumns& b, std::size_t i, const TriangleLanes& t,
                       std::uint32_t lane) {
  const Floats d;
  const V slack = hn::Set(d, t.slack[lane]);
  M some_below = hn::Lt(slack, slack), some_above = some_below;
  for (int e = 0; e < 3; ++e) {
    const float ku = t.slope_u[e][lane], kv = t.slope_v[e][lane];
    const V slope_u = hn::Set(d, ku), slope_v = hn::Set(d, kv), edge = hn::Set(d, t.edge[e][lane]);
    const bool up = ku > 0, right = kv > 0;
    const V least = hn::Add(hn::Add(edge, hn::Mul(slope_u, hn::LoadU(d, (up ? b.du0 : b.du1) + i))),
                            hn::Mul(slope_v, hn::LoadU(d, (right ? b.dv0 : b.dv1) + i)));
    const V most = hn::Add(hn::Add(edge, hn::Mul(slope_u, hn::LoadU(d, (up ? b.du1 : b.du0) + i))),
                           hn::Mul(slope_v, hn::LoadU(d, (right ? b.dv1 : b.dv0) + i)));
    some_below = hn::Or(some_below, hn::Lt(most, hn::Neg(slack)));
    some_above = hn::Or(some_above, hn::Gt(least, slack));
  }
  return hn::Not(hn::And(some_below, some_above));
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // the toggle
