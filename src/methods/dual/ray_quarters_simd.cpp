// `quarter_of` for as many rays at a time as a vector has lanes. Compiled once for each SIMD target
// and chosen at run time (Google Highway).
#include "methods/dual/ray_order.h"

#include <bit>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/dual/ray_quarters_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Bits = hn::RebindToUnsigned<Floats>;
using V = hn::Vec<Floats>;

#if HWY_TARGET != HWY_SCALAR
/// The directions of as many rays as there are lanes. A ray is two quads of floats, origin and
/// direction, so half a vector's rays fill four vectors, whose even lanes are origins. Adds to
/// `differ` the bits in which their origins and t_min differ from those of `first`.
HWY_INLINE void LoadDirections(const Ray* rays, const Ray& first, V* x, V* y, V* z,
                               hn::Vec<Bits>* differ) {
  const Floats d;
  const Bits db;
  V x0, y0, z0, t0, x1, y1, z1, t1;
  hn::LoadInterleaved4(d, &rays[0].origin.x, x0, y0, z0, t0);
  hn::LoadInterleaved4(d, &rays[hn::Lanes(d) / 2].origin.x, x1, y1, z1, t1);
  *x = hn::ConcatOdd(d, x1, x0);
  *y = hn::ConcatOdd(d, y1, y0);
  *z = hn::ConcatOdd(d, z1, z0);
  const auto compare = [&](V upper, V lower, float with) HWY_ATTR {
    const V even = hn::ConcatEven(d, upper, lower);
    *differ = hn::Or(*differ, hn::Xor(hn::BitCast(db, even), hn::BitCast(db, hn::Set(d, with))));
  };
  compare(x1, x0, first.origin.x);
  compare(y1, y0, first.origin.y);
  compare(z1, z0, first.origin.z);
  compare(t1, t0, first.t_min);
}
#endif

bool FindQuarters(View<const Ray> rays, const Ray& first, std::uint8_t* quarters) {
  std::size_t i = 0;
  bool same = true;
#if HWY_TARGET != HWY_SCALAR
  const Floats d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::RebindToUnsigned<decltype(d)> du;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  using U = hn::Vec<decltype(du)>;
  const U one = hn::Set(du, 1), two = hn::Set(du, 2), zero = hn::Zero(du);
  const auto where = [&](auto mask, U yes, U no) {
    return hn::IfThenElse(hn::RebindMask(du, mask), yes, no);
  };
  U differ = zero;
  for (; i + hn::Lanes(d) <= rays.size; i += hn::Lanes(d)) {
    V dx, dy, dz;
    LoadDirections(rays.data + i, first, &dx, &dy, &dz, &differ);
    const V x = hn::Abs(dx), y = hn::Abs(dy), z = hn::Abs(dz);
    const auto x_over_y = hn::Gt(x, y);
    const auto over_z = hn::Gt(hn::IfThenElse(x_over_y, x, y), z);
    const U axis = where(over_z, where(x_over_y, zero, one), two);
    const auto sign = [&](V v) { return hn::ShiftRight<31>(hn::BitCast(du, v)); };
    const U signs =
        hn::Or(hn::Or(hn::ShiftLeft<2>(sign(dx)), hn::ShiftLeft<1>(sign(dy))), sign(dz));
    const U turned = hn::Or(hn::Shl(signs, axis), hn::Shr(signs, hn::Sub(hn::Set(du, 3), axis)));
    const U quarter = hn::Add(hn::ShiftLeft<3>(axis), hn::And(turned, hn::Set(du, 7)));
    hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(di, quarter)), bytes, quarters + i);
  }
  same = hn::AllTrue(du, hn::Eq(differ, zero));
#endif
  for (; i < rays.size; ++i) {
    quarters[i] = static_cast<std::uint8_t>(quarter_of(rays[i].direction));
    same = same && std::memcmp(&rays[i].origin, &first.origin, sizeof first.origin) == 0 &&
           std::bit_cast<std::uint32_t>(rays[i].t_min) == std::bit_cast<std::uint32_t>(first.t_min);
  }
  return same;
}

}  // namespace
}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(FindQuarters);

bool find_quarters(View<const Ray> rays, const Ray& first, std::uint8_t* quarters) {
  return HWY_DYNAMIC_DISPATCH(FindQuarters)(rays, first, quarters);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
