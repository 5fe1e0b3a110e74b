// Columns of surfaces as SIMD vectors. Included once for each SIMD target.
#if defined(RAYSHEAF_SCENE_SURFACE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSHEAF_SCENE_SURFACE_LANES_INL_H_
#undef RAYSHEAF_SCENE_SURFACE_LANES_INL_H_
#else
#define RAYSHEAF_SCENE_SURFACE_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cstring>

#include "surface/surface_columns.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// As many floats as a vector has doubles, so that both have the same lanes.
using Doubles = hn::CappedTag<double, kSurfaceLanes>;
using Floats = hn::Rebind<float, Doubles>;
using Ints = hn::RebindToSigned<Floats>;
using F = hn::Vec<Floats>;
using D = hn::Vec<Doubles>;
using I = hn::Vec<Ints>;
using FM = hn::Mask<Floats>;
using DM = hn::Mask<Doubles>;

struct F3 {
  F x, y, z;
};
struct D3 {
  D x, y, z;
};

HWY_INLINE F set(float x) {
  return hn::Set(Floats(), x);
}
HWY_INLINE F load(const SurfaceColumn& column, std::size_t k) {
  return hn::Load(Floats(), column + k);
}
HWY_INLINE F3 load3(const SurfaceColumn (&columns)[3], std::size_t k) {
  return {load(columns[0], k), load(columns[1], k), load(columns[2], k)};
}
HWY_INLINE void store(F x, SurfaceColumn& column, std::size_t k) {
  hn::Store(x, Floats(), column + k);
}
HWY_INLINE void store3(const F3& a, SurfaceColumn (&columns)[3], std::size_t k) {
  store(a.x, columns[0], k);
  store(a.y, columns[1], k);
  store(a.z, columns[2], k);
}
template <class Tag, class Mask>
HWY_INLINE LaneBits bits_of(Tag d, Mask mask, std::size_t k) {
  alignas(8) std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  std::uint16_t bits;
  std::memcpy(&bits, bytes, sizeof bits);
  return (bits & ((1u << hn::Lanes(d)) - 1)) << k;
}
/// The lanes of `bits` from lane `k` on.
HWY_INLINE FM mask_of(LaneBits bits, std::size_t k) {
  const Ints d;
  const I bit = hn::Shl(hn::Set(d, 1), hn::Iota(d, 0));
  return hn::RebindMask(
      Floats(),
      hn::Ne(hn::And(hn::Set(d, static_cast<std::int32_t>(bits >> k)), bit), hn::Zero(d)));
}

HWY_INLINE F3 minus(const F3& a, const F3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE F dot(const F3& a, const F3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE F larger(F a, F b) {
  return hn::IfThenElse(hn::Gt(a, b), a, b);
}
HWY_INLINE F3 select(FM mask, const F3& yes, const F3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}
HWY_INLINE F3 negated(const F3& a) {
  return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)};
}

/// The weights of a column, for `mixed`.
struct Weights {
  F first, second, third;
};
HWY_INLINE Weights weights_at(const SurfaceColumns& c, std::size_t k) {
  const F u = load(c.u, k), v = load(c.v, k);
  return {hn::Sub(hn::Sub(set(1), u), v), u, v};
}
HWY_INLINE F mix(const Weights& w, F a, F b, F c) {
  return hn::Add(hn::Add(hn::Mul(a, w.first), hn::Mul(b, w.second)), hn::Mul(c, w.third));
}

}  // namespace
}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // the toggle
