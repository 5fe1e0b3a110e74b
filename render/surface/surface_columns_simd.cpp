// Compiled once for each SIMD target and chosen at run time (Google Highway). No operation is
// fused, so that every target gives the bits of the scalar functions.
#include "base/float.h"
#include "intersect/triangle_body.h"
#include "render/surface/surface_columns.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/surface/surface_columns_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "intersect/values-inl.h"
#include "render/surface/surface_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {
HWY_INLINE D3 widened(const F3& a) {
  const Doubles d;
  return {hn::PromoteTo(d, a.x), hn::PromoteTo(d, a.y), hn::PromoteTo(d, a.z)};
}
HWY_INLINE D3 difference(const F3& a, const F3& b) {
  return minus(widened(a), widened(b));
}
HWY_INLINE FM narrowed(DM mask) {
  const Doubles d;
  const Floats df;
  return hn::Ne(hn::DemoteTo(df, hn::IfThenElseZero(mask, hn::Set(d, 1.0))), hn::Zero(df));
}
/// `unit`; `known`: the lanes that have a direction; others hold arbitrary values.
HWY_INLINE F3 unit(const D3& a, FM* known) {
  const Doubles d;
  const Floats df;
  const D size = hn::Sqrt(dot(a, a));
  const D infinite = hn::Set(d, std::numeric_limits<double>::infinity());
  *known = narrowed(hn::And(hn::Gt(size, hn::Zero(d)), hn::Lt(size, infinite)));
  return {hn::DemoteTo(df, hn::Div(a.x, size)), hn::DemoteTo(df, hn::Div(a.y, size)),
          hn::DemoteTo(df, hn::Div(a.z, size))};
}

LaneBits FindWeights(SurfaceColumns* columns) {
  static_assert(kValueLanes == kSurfaceLanes);
  SurfaceColumns& c = *columns;
  ValueColumns values;
  std::memcpy(values.origin, c.origin, sizeof values.origin);
  std::memcpy(values.direction, c.direction, sizeof values.direction);
  std::memcpy(values.corner, c.corner, sizeof values.corner);
  const std::uint32_t met = find_values(&values).met;
  const Floats d;
  LaneBits settled = 0;
  for (std::size_t k = 0; k < kSurfaceLanes; k += hn::Lanes(d)) {
    const F t = hn::Load(d, values.t + k);
    const FM within = hn::And(hn::Ge(t, load(c.t_min, k)), hn::Le(t, load(c.t_max, k)));
    settled |= bits_of(d, within) << k;
    store(hn::Load(d, values.u + k), c.u, k);
    store(hn::Load(d, values.v + k), c.v, k);
  }
  return settled & met;
}

LaneBits FindIncoming(SurfaceColumns* columns) {
  SurfaceColumns& c = *columns;
  const Floats d;
  LaneBits right = 0;
  for (std::size_t k = 0; k < kSurfaceLanes; k += hn::Lanes(d)) {
    const F3 a = load3(c.direction, k);
    const F n = hn::Sqrt(dot(a, a));
    store3(divided(a, n), c.incoming, k);
    right |= bits_of(d, hn::And(hn::Gt(n, set(1e-15f)), hn::Lt(n, set(1e15f)))) << k;
  }
  return right;
}

/// One axis of `mixed_point`: stores the position, returns the reach along it.
HWY_INLINE F mix_corners(F a, F b, F c, SurfaceColumns& columns, std::size_t axis, std::size_t k) {
  const Doubles d;
  const D u = hn::PromoteTo(d, load(columns.u, k)), v = hn::PromoteTo(d, load(columns.v, k));
  const D w = hn::Sub(hn::Sub(hn::Set(d, 1.0), u), v);
  const D sum = hn::Add(hn::Add(hn::Mul(hn::PromoteTo(d, a), w), hn::Mul(hn::PromoteTo(d, b), u)),
                        hn::Mul(hn::PromoteTo(d, c), v));
  const F at = hn::DemoteTo(Floats(), sum);
  store(at, columns.position[axis], k);
  return larger(hn::Abs(hn::Sub(a, at)), larger(hn::Abs(hn::Sub(b, at)), hn::Abs(hn::Sub(c, at))));
}

/// SIMD version of `raysheaf::clearance`.
HWY_INLINE F clearance(const F3& position, const F3& normal, F reach) {
  const auto part = [](F n, F p) { return hn::Mul(hn::Abs(n), hn::Abs(p)); };
  const F off = hn::Add(hn::Add(part(normal.x, position.x), part(normal.y, position.y)),
                        part(normal.z, position.z));
  const F roundings = hn::Add(hn::Mul(set(2), off), hn::Mul(set(kClearOfReach), reach));
  return hn::Add(hn::Mul(roundings, set(kUnitRoundoff)), set(0x1p-147f));
}

/// The corners' normals, interpolated and transformed by the instance.
HWY_INLINE F3 mapped_normal(const SurfaceColumns& c, std::size_t k, const Weights& w,
                            const NormalMap& map, FM* known) {
  const Doubles d;
  const auto mixed = [&](std::size_t axis) {
    return mix(w, load(c.normal[0][axis], k), load(c.normal[1][axis], k),
               load(c.normal[2][axis], k));
  };
  const D3 wide = widened({mixed(0), mixed(1), mixed(2)});
  const D side = hn::Set(d, map.side);
  const D3 n = times(wide, side);
  const auto sum = [&](double yz, double zx, double xy) {
    return hn::Add(hn::Add(hn::Mul(hn::Set(d, yz), n.x), hn::Mul(hn::Set(d, zx), n.y)),
                   hn::Mul(hn::Set(d, xy), n.z));
  };
  return unit({sum(map.yz.x, map.zx.x, map.xy.x), sum(map.yz.y, map.zx.y, map.xy.y),
               sum(map.yz.z, map.zx.z, map.xy.z)},
              known);
}

LaneBits PlaceSurfaces(const InstanceLanes* instances, std::size_t count, LaneBits mirrored,
                       SurfaceColumns* columns, LaneBits* front) {
  SurfaceColumns& c = *columns;
  const Floats d;
  const Doubles dd;
  LaneBits right = 0, in_front = 0;
  for (std::size_t k = 0; k < kSurfaceLanes; k += hn::Lanes(d)) {
    const F3 p = load3(c.corner[0], k), q = load3(c.corner[1], k), r = load3(c.corner[2], k);
    FM known;
    const F3 normal = unit(cross(difference(q, p), difference(r, p)), &known);
    const F3 facing = select(mask_of(d, mirrored >> k), negated(normal), normal);
    // None of the products may have underflowed.
    const F zero = hn::Zero(d);
    const FM flat =
        hn::And(hn::And(hn::Eq(facing.x, zero), hn::Eq(facing.y, zero)), hn::Eq(facing.z, zero));
    right |= bits_of(d, hn::AndNot(flat, known)) << k;

    const F reach =
        larger(mix_corners(p.x, q.x, r.x, c, 0, k),
               larger(mix_corners(p.y, q.y, r.y, c, 1, k), mix_corners(p.z, q.z, r.z, c, 2, k)));
    store(clearance(load3(c.position, k), facing, reach), c.clearance, k);

    const D along = dot(widened(facing), widened(load3(c.incoming, k)));
    const FM behind = narrowed(hn::Gt(along, hn::Zero(dd)));
    F3 shading = facing;
    for (std::size_t i = 0; i < count; ++i) {
      if ((instances[i].lanes >> k & ((1u << hn::Lanes(d)) - 1)) == 0) continue;
      FM has_direction;
      const F3 mapped = mapped_normal(c, k, weights_at(c, k), instances[i].map, &has_direction);
      shading =
          select(hn::And(mask_of(d, instances[i].lanes >> k), has_direction), mapped, shading);
    }
    // SIMD version of `on_side_of`.
    const FM opposed = narrowed(hn::Lt(dot(widened(shading), widened(facing)), hn::Zero(dd)));
    shading = select(opposed, negated(shading), shading);
    store3(select(behind, negated(facing), facing), c.geometric, k);
    store3(select(behind, negated(shading), shading), c.shading, k);
    in_front |= bits_of(d, hn::Not(behind)) << k;
  }
  *front = in_front;
  return right;
}

}  // namespace
}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(FindWeights);
HWY_EXPORT(FindIncoming);
HWY_EXPORT(PlaceSurfaces);

LaneBits find_weights(SurfaceColumns* columns) {
  return HWY_DYNAMIC_DISPATCH(FindWeights)(columns);
}

LaneBits find_incoming(SurfaceColumns* columns) {
  return HWY_DYNAMIC_DISPATCH(FindIncoming)(columns);
}

LaneBits place_surfaces(const InstanceLanes* instances, std::size_t count, LaneBits mirrored,
                        SurfaceColumns* columns, LaneBits* front) {
  return HWY_DYNAMIC_DISPATCH(PlaceSurfaces)(instances, count, mirrored, columns, front);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
