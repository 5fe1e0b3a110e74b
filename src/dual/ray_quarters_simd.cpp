// `quarter_of`, as many rays at a time as a vector has lanes. Compiled once a SIMD target and
// chosen at run time (Google Highway).
#include "dual/ray_order.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dual/ray_quarters_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

void FindQuarters(View<const Ray> rays, std::uint8_t* quarters) {
  const hn::CappedTag<float, 16> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::RebindToUnsigned<decltype(d)> du;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  using V = hn::Vec<decltype(d)>;
  using U = hn::Vec<decltype(du)>;
  constexpr std::size_t kFloats = sizeof(Ray) / sizeof(float);
  const auto places = hn::Mul(hn::Iota(di, 0), hn::Set(di, static_cast<std::int32_t>(kFloats)));
  const U one = hn::Set(du, 1), two = hn::Set(du, 2), zero = hn::Zero(du);
  const auto where = [&](auto mask, U yes, U no) {
    return hn::IfThenElse(hn::RebindMask(du, mask), yes, no);
  };
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= rays.size; i += hn::Lanes(d)) {
    const float* const at = &rays[i].direction.x;
    const V dx = hn::GatherIndex(d, at, places), dy = hn::GatherIndex(d, at + 1, places);
    const V dz = hn::GatherIndex(d, at + 2, places);
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
  for (; i < rays.size; ++i) quarters[i] = static_cast<std::uint8_t>(quarter_of(rays[i].direction));
}

}  // namespace
}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(FindQuarters);

void find_quarters(View<const Ray> rays, std::uint8_t* quarters) {
  HWY_DYNAMIC_DISPATCH(FindQuarters)(rays, quarters);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
