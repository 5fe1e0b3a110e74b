// Stage 1 of the ray-triangle test (intersect/triangle_body.h) in vectors: edge functions with
// their error bounds, of a triangle in each lane or for a ray in each. Included once for each SIMD
// target.
#if defined(RAYSHEAF_INTERSECT_EDGES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSHEAF_INTERSECT_EDGES_INL_H_
#undef RAYSHEAF_INTERSECT_EDGES_INL_H_
#else
#define RAYSHEAF_INTERSECT_EDGES_INL_H_
#endif

#include <hwy/highway.h>

#include "intersect/triangle_body.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A corner, seen from the ray's origin and sheared along its axes.
template <class D>
struct Corner {
  hn::Vec<D> x, y, z;
};

template <class D>
HWY_INLINE Corner<D> sheared(D /*d*/, hn::Vec<D> x, hn::Vec<D> y, hn::Vec<D> z, hn::Vec<D> shear_x,
                             hn::Vec<D> shear_y) {
  return {hn::Sub(x, hn::Mul(shear_x, z)), hn::Sub(y, hn::Mul(shear_y, z)), z};
}

template <class V>
HWY_INLINE V edge_of(V px, V py, V qx, V qy) {
  return hn::Sub(hn::Mul(px, qy), hn::Mul(py, qx));
}

/// The edge functions of lanes and their error bounds.
template <class D>
struct Edges {
  hn::Vec<D> u, v, w, size, error, least, most;
  hn::Mask<D> possible;  ///< not certainly a miss
};
/// `depth`: at least |z| of the corners, less their distance from each other.
template <class D>
HWY_INLINE Edges<D> edges_of(D d, const Corner<D>& a, const Corner<D>& b, const Corner<D>& c,
                             hn::Vec<D> reach, hn::Vec<D> depth) {
  using hn::Add, hn::Max, hn::Min, hn::Mul, hn::Set;
  Edges<D> e;
  e.u = edge_of(c.x, c.y, b.x, b.y);
  e.v = edge_of(a.x, a.y, c.x, c.y);
  e.w = edge_of(b.x, b.y, a.x, a.y);
  e.size = Add(depth, reach);
  e.error =
      Mul(e.size, Add(Mul(Set(d, kErrorOfSquare), e.size), Mul(Set(d, kErrorOfReach), reach)));
  e.least = Min(Min(e.u, e.v), e.w);
  e.most = Max(Max(e.u, e.v), e.w);
  e.possible = hn::Not(hn::Gt(Min(hn::Neg(e.least), e.most), e.error));
  return e;
}

template <class D>
HWY_INLINE Edges<D> edges_of(D d, const Corner<D>& a, const Corner<D>& b, const Corner<D>& c,
                             hn::Vec<D> reach) {
  return edges_of(d, a, b, c, reach, hn::Abs(a.z));
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // the toggle
