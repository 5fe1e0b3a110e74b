// Columns of surfaces as SIMD vectors. Included once for each SIMD target.
#if defined(RAYSHEAF_SCENE_SURFACE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSHEAF_SCENE_SURFACE_LANES_INL_H_
#undef RAYSHEAF_SCENE_SURFACE_LANES_INL_H_
#else
#define RAYSHEAF_SCENE_SURFACE_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "base/lanes-inl.h"
#include "render/surface/surface_columns.h"

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

using F3 = Lanes3<F>;
using D3 = Lanes3<D>;

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
