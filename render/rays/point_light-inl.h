// A point light seen from many fragments at once: `sample_point` of light_body.h, with the same
// operations in the same order. Included once for each SIMD target.
#if defined(RAYSHEAF_RAYGEN_POINT_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSHEAF_RAYGEN_POINT_LIGHT_INL_H_
#undef RAYSHEAF_RAYGEN_POINT_LIGHT_INL_H_
#else
#define RAYSHEAF_RAYGEN_POINT_LIGHT_INL_H_
#endif

#include "render/rays/fragment_lanes-inl.h"
#include "render/rays/point_light.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
struct PointSeen {
  V3 to_light;
  V distance;
  V3 irradiance;
  M usual;  ///< the other lanes need `sample_point` itself
};

HWY_INLINE PointSeen SeePoint(const PlacedLight& light, const V3& position) {
  const Floats d;
  const V one = hn::Set(d, 1.0f);
  PointSeen seen;
  const V3 to_light = minus(Splat(light.position), position);
  seen.distance = hn::Sqrt(dot(to_light, to_light));
  seen.usual = IsUsual(seen.distance);
  seen.to_light = divided(to_light, seen.distance);
  V window = one;
  if (light.has_range) {
    const V ratio = hn::Div(seen.distance, hn::Set(d, light.range));
    const V fourth = hn::Mul(hn::Mul(hn::Mul(ratio, ratio), ratio), ratio);
    window = Clamp(hn::Sub(one, fourth), 0, 1);
  }
  if (light.is_spot) {
    const V3 from_light = negated(seen.to_light);
    const V above = hn::Sub(dot(Splat(light.direction), from_light), hn::Set(d, light.cos_outer));
    const V inside = Clamp(hn::Div(above, hn::Set(d, light.span)), 0, 1);
    window = hn::Mul(window, hn::Mul(inside, inside));
  }
  const V falloff = hn::Div(hn::Div(window, seen.distance), seen.distance);
  seen.irradiance = times(Splat(light.intensity), falloff);
  return seen;
}

}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // the toggle
