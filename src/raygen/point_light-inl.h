// A light that shines from a point, seen from many places at once: `sample_point` of light_body.h,
// its operations in its order. Included once a SIMD target.
#if defined(RAYSHEAF_RAYGEN_POINT_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSHEAF_RAYGEN_POINT_LIGHT_INL_H_
#undef RAYSHEAF_RAYGEN_POINT_LIGHT_INL_H_
#else
#define RAYSHEAF_RAYGEN_POINT_LIGHT_INL_H_
#endif

#include <hwy/highway.h>

#include <cstdint>
#include <cstring>

#include "raygen/point_light.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLightLanes>;
using V = hn::Vec<Floats>;
using M = hn::Mask<Floats>;

struct V3 {
  V x, y, z;
};

/// Bits of a mask, lane 0 lowest.
HWY_INLINE std::uint32_t BitsOf(M mask) {
  const Floats d;
  alignas(8) std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  std::uint16_t bits;
  std::memcpy(&bits, bytes, sizeof bits);
  return bits & ((1u << hn::Lanes(d)) - 1);
}

HWY_INLINE V3 Splat(Vec3 a) {
  const Floats d;
  return {hn::Set(d, a.x), hn::Set(d, a.y), hn::Set(d, a.z)};
}
HWY_INLINE V3 Load3(const float (&columns)[3][kLightBlock], std::size_t k) {
  const Floats d;
  return {hn::Load(d, columns[0] + k), hn::Load(d, columns[1] + k), hn::Load(d, columns[2] + k)};
}
HWY_INLINE V3 Sub(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 Add(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 Mul(const V3& a, const V3& b) {
  return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}
HWY_INLINE V3 Scale(const V3& a, V s) {
  return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
HWY_INLINE V Dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
/// As `max` has it of a NaN.
HWY_INLINE V Larger(V a, V b) {
  return hn::IfThenElse(hn::Gt(a, b), a, b);
}
HWY_INLINE V MaxOf(const V3& a) {
  return Larger(Larger(a.x, a.y), a.z);
}
HWY_INLINE V Clamp(V x, float lo, float hi) {
  const Floats d;
  const V low = hn::Set(d, lo), high = hn::Set(d, hi);
  return hn::IfThenElse(hn::Lt(x, low), low, hn::IfThenElse(hn::Gt(x, high), high, x));
}

/// `normalized` of a vector of this length is a division where this holds.
HWY_INLINE M IsUsual(V length) {
  const Floats d;
  return hn::And(hn::Gt(length, hn::Set(d, 1e-15f)), hn::Lt(length, hn::Set(d, 1e15f)));
}
HWY_INLINE V3 Divided(const V3& a, V length) {
  return {hn::Div(a.x, length), hn::Div(a.y, length), hn::Div(a.z, length)};
}

struct PointSeen {
  V3 to_light;
  V distance;
  V3 irradiance;
  M usual;  ///< the other lanes are for `sample_point` itself
};

HWY_INLINE PointSeen SeePoint(const PlacedLight& light, const V3& position) {
  const Floats d;
  const V one = hn::Set(d, 1.0f);
  PointSeen seen;
  const V3 to_light = Sub(Splat(light.position), position);
  seen.distance = hn::Sqrt(Dot(to_light, to_light));
  seen.usual = IsUsual(seen.distance);
  seen.to_light = Divided(to_light, seen.distance);
  V window = one;
  if (light.has_range) {
    const V ratio = hn::Div(seen.distance, hn::Set(d, light.range));
    const V fourth = hn::Mul(hn::Mul(hn::Mul(ratio, ratio), ratio), ratio);
    window = Clamp(hn::Sub(one, fourth), 0, 1);
  }
  if (light.is_spot) {
    const V3 from_light{hn::Neg(seen.to_light.x), hn::Neg(seen.to_light.y),
                        hn::Neg(seen.to_light.z)};
    const V above = hn::Sub(Dot(Splat(light.direction), from_light), hn::Set(d, light.cos_outer));
    const V inside = Clamp(hn::Div(above, hn::Set(d, light.span)), 0, 1);
    window = hn::Mul(window, hn::Mul(inside, inside));
  }
  const V falloff = hn::Div(hn::Div(window, seen.distance), seen.distance);
  seen.irradiance = Scale(Splat(light.intensity), falloff);
  return seen;
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // the toggle
