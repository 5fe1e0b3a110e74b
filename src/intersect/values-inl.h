// Stage 2 of the ray-triangle test in vectors: t, u and v of hits, `values_of_hit` operation by
// operation, and intersect/plane.h. Included once for each SIMD target.
#if defined(RAYSHEAF_INTERSECT_VALUES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSHEAF_INTERSECT_VALUES_INL_H_
#undef RAYSHEAF_INTERSECT_VALUES_INL_H_
#else
#define RAYSHEAF_INTERSECT_VALUES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cstdint>

#include "base/lanes-inl.h"
#include "intersect/plane.h"
#include "intersect/triangle_body.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

inline constexpr std::size_t kValueLanes = 16;

/// Rays and triangles in columns, one lane each, and their shared values.
struct alignas(64) ValueColumns {
  float origin[3][kValueLanes], direction[3][kValueLanes];  ///< [axis]
  float corner[3][3][kValueLanes];                          ///< [corner][axis]
  float t[kValueLanes], u[kValueLanes], v[kValueLanes];

  [[nodiscard]] Vec3 point(const float (&p)[3][kValueLanes], std::size_t lane) const {
    return {p[0][lane], p[1][lane], p[2][lane]};
  }
};

/// The lanes that binary64 decides, and those of them that certainly hit, as bits.
struct ValuedLanes {
  std::uint32_t valued = 0, met = 0;
};

/// Computes t, u and v of the valued lanes among the first `count`; other lanes get arbitrary
/// values.
///
/// The bounds of `Determinants` are sums of magnitudes. Here they are computed from the largest
/// coordinates, which is faster and less tight: with e, f <= q, k <= s and d <= l, the sums for
/// det, u and v are at most 6 l q (q + s), for t 6 s q^2. If these bounds suffice, those of
/// `Determinants` do.
HWY_INLINE ValuedLanes find_values(ValueColumns* columns, std::size_t count = kValueLanes) {
  using hn::Abs, hn::Add, hn::And, hn::Div, hn::Gt, hn::Le, hn::Lt, hn::Max, hn::Min, hn::Mul,
      hn::Neg, hn::Sub;
  using Doubles = hn::CappedTag<double, kValueLanes>;
  const Doubles d;
  const hn::Rebind<float, Doubles> df;
  using Lanes = hn::Vec<Doubles>;
  ValueColumns& c = *columns;
  ValuedLanes result;
  for (std::size_t g = 0; g < count; g += hn::Lanes(d)) {
    const auto load = [&](const float* p) { return hn::PromoteTo(d, hn::Load(df, p + g)); };
    const auto load3 = [&](const float(&column)[3][kValueLanes]) {
      return Lanes3<Lanes>{load(column[0]), load(column[1]), load(column[2])};
    };
    const auto a = load3(c.corner[0]), l = load3(c.direction);
    const auto e = minus(load3(c.corner[1]), a), f = minus(load3(c.corner[2]), a);
    const auto k = minus(a, load3(c.origin)), n = cross(e, f), m = cross(k, l);
    const Lanes det = dot(n, l), distance = dot(n, k), u = dot(m, f), v = Neg(dot(m, e));
    const Lanes size = Abs(det);
    const Lanes q = Max(largest(e), largest(f)), s = largest(k), q_s = Mul(q, Add(q, s));
    // 8 instead of 6, because these are rounded, too.
    const Lanes error = Mul(hn::Set(d, 0x1p-47), Mul(largest(l), q_s));
    const Lanes t_error = Mul(hn::Set(d, 0x1p-46), Mul(s, Mul(q, q)));
    const auto settles = [&](Lanes wrong, Lanes right) {
      return Le(wrong, Mul(hn::Set(d, 0x1p-28), right));
    };
    // For a triangle that is a point, and for values that are not finite, all comparisons are
    // false.
    const auto valued =
        And(And(settles(error, size), Gt(size, error)), settles(t_error, Abs(distance)));
    const Lanes w = Sub(Sub(det, u), v), slack = Mul(hn::Set(d, 6.0), error);
    const Lanes low = Min(Min(u, v), w), high = Max(Max(u, v), w);
    const auto met = hn::Or(Gt(low, slack), Lt(high, Neg(slack)));
    const auto rounded = [&](Lanes x) { return hn::DemoteTo(df, Div(x, det)); };
    const auto zero = hn::Zero(df), one = hn::Set(df, 1.0f);
    const auto weight = [&](Lanes x) { return hn::Min(hn::Max(rounded(x), zero), one); };
    hn::Store(hn::Add(rounded(distance), zero), df, c.t + g);
    hn::Store(weight(u), df, c.u + g);
    hn::Store(weight(v), df, c.v + g);
    result.valued |= bits_of(d, valued) << g;
    result.met |= bits_of(d, And(valued, met)) << g;
  }
  return result;
}

/// Computes the values of lanes that are known hits, by any stage.
inline void settle_values(std::uint32_t hits, ValueColumns* columns,
                          std::size_t count = kValueLanes) {
  ValueColumns& c = *columns;
  for (std::uint32_t rest = hits & ~find_values(columns, count).valued; rest != 0;
       rest &= rest - 1) {
    const auto lane = static_cast<std::size_t>(__builtin_ctz(rest));
    const TriangleHit hit = values_of_hit(c.point(c.origin, lane), c.point(c.direction, lane),
                                          c.point(c.corner[0], lane), c.point(c.corner[1], lane),
                                          c.point(c.corner[2], lane));
    c.t[lane] = hit.t, c.u[lane] = hit.u, c.v[lane] = hit.v;
  }
}

/// Rays in columns, as in `RaySetup`: x, y and z are its axes.
struct SetupColumns {
  const float *ox, *oy, *oz, *shear_x, *shear_y, *shear_z, *t_min, *t_max;
};

/// The determinants det and n . k of rays and the plane of a triangle, and their error bounds
/// (intersect/plane.h).
template <class D>
struct PlaneLanes {
  hn::Vec<D> det, det_off, distance, distance_off;
};

/// `Plane::surely_beyond`, as bits, for as many rays as `D` has lanes.
template <class D>
HWY_INLINE std::uint32_t beyond_plane(D d, const PlaneLanes<D>& p, const float* shear_z,
                                      const float* t_min_of, const float* t_max_of) {
  using hn::Abs, hn::Add, hn::And, hn::Ge, hn::Gt, hn::Lt, hn::Max, hn::Mul, hn::Neg, hn::Or,
      hn::Sub;
  using Lanes = hn::Vec<D>;
  const hn::Rebind<float, D> df;
  const auto load = [&](const float* from) { return hn::PromoteTo(d, hn::Load(df, from)); };
  const auto all = [&](double x) { return hn::Set(d, x); };
  const Lanes per_z = load(shear_z), per_size = Abs(per_z);
  const Lanes size = Abs(p.det), over = Mul(p.distance, per_z);
  const Lanes along = hn::IfThenElse(Lt(p.det, hn::Zero(d)), Neg(over), over);
  const Lanes off = Add(Mul(p.distance_off, per_size), Mul(all(Plane::kRounding), Abs(over)));
  const Lanes tiny = all(0x1p-149);
  const Lanes t_min = load(t_min_of), t_max = load(t_max_of), part = all(0x1p-23);
  const Lanes below = Sub(Sub(t_min, Mul(part, Abs(t_min))), tiny);
  const Lanes least = hn::IfThenElse(Ge(t_min, hn::Zero(d)), Max(below, hn::Zero(d)), below);
  const Lanes most = Add(Add(t_max, Mul(part, Abs(t_max))), tiny);
  const auto outside = Or(Lt(Add(along, off), Sub(Mul(least, size), Mul(Abs(least), p.det_off))),
                          Gt(Sub(along, off), Add(Mul(most, size), Mul(Abs(most), p.det_off))));
  const auto sure = And(Gt(size, p.det_off), Ge(per_size, all(0x1p-100)));
  return bits_of(d, And(sure, outside));
}

/// Bits of the first `lanes` rays, which fill vectors, for which `Plane::surely_beyond` is true.
HWY_INLINE std::uint32_t lanes_beyond(std::size_t lanes, const SetupColumns& rays, Vec3 corner_a,
                                      Vec3 corner_b, Vec3 corner_c) {
  using hn::Abs, hn::Add, hn::Max, hn::Mul, hn::Sub;
  using Doubles = hn::CappedTag<double, kValueLanes>;
  const Doubles d;
  const hn::Rebind<float, Doubles> df;
  using Lanes = hn::Vec<Doubles>;
  const Plane plane(corner_a, corner_b, corner_c);
  const auto all = [&](double x) { return hn::Set(d, x); };
  const Lanes nx = all(plane.nx), ny = all(plane.ny), nz = all(plane.nz);
  std::uint32_t beyond = 0;
  for (std::size_t g = 0; g < lanes; g += hn::Lanes(d)) {
    const auto load = [&](const float* p) { return hn::PromoteTo(d, hn::Load(df, p + g)); };
    const Lanes kx = Sub(all(corner_a.x), load(rays.ox)), ky = Sub(all(corner_a.y), load(rays.oy)),
                kz = Sub(all(corner_a.z), load(rays.oz));
    const Lanes det = Add(Add(Mul(nx, load(rays.shear_x)), Mul(ny, load(rays.shear_y))), nz);
    const Lanes distance = Add(Add(Mul(nx, kx), Mul(ny, ky)), Mul(nz, kz));
    const Lanes off = Mul(all(plane.t_off), Max(Max(Abs(kx), Abs(ky)), Abs(kz)));
    beyond |= beyond_plane(d, {det, all(plane.det_off), distance, off}, rays.shear_z + g,
                           rays.t_min + g, rays.t_max + g)
              << g;
  }
  return beyond;
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // the toggle
