// Computes the glow of 16 fragments at a time: `scattered_parts`, `rays_of` and `glow`, with the
// same operations in the same order. Compiled once for each SIMD target and chosen at run time
// (Google Highway).
#include "render/shade/glow.h"

#include <algorithm>

#include "render/rays/scatter_body.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/shade/glow_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/rays/fragment_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {

/// Stores `yes` or 0 as a byte for each of `count` lanes.
HWY_INLINE void GiveBytes(M lanes, std::uint8_t yes, std::size_t count, std::uint8_t* to) {
  const hn::RebindToSigned<Floats> ints;
  const hn::Rebind<std::uint8_t, Floats> bytes;
  const auto values = hn::DemoteTo(
      bytes, hn::IfThenElseZero(hn::RebindMask(ints, lanes), hn::Set(ints, std::int32_t{yes})));
  alignas(64) std::uint8_t part[kLightLanes];
  hn::Store(values, bytes, part);
  std::memcpy(to, part, std::min(count, hn::Lanes(bytes)));
}

void FindGlow(View<const Fragment> fragments, const GlowLook& look, Vec3* radiance,
              std::uint8_t* going_on, std::uint16_t* odd) {
  const Floats d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const V3 sky = Splat(look.sky);
  const M traced = hn::Gt(hn::Set(d, (look.kinds & kReflects) != 0 ? 1.0f : 0), zero);
  std::fill_n(odd, (fragments.size + kLightLanes - 1) / kLightLanes, std::uint16_t{0});
  for (std::size_t k = 0; k < fragments.size; k += hn::Lanes(d)) {
    const FragmentLanes f(fragments, k);
    const std::size_t left = fragments.size - k;
    const M is_there = HasTriangle(f.At<RAYSHEAF_WORD(triangle)>());
    const M is_lit = IsLit(f.At<RAYSHEAF_SURFACE_WORD(unlit)>());
    const V3 emission = f.At3<RAYSHEAF_SURFACE_WORD(emission)>();
    const V cosine =
        CosArrival(f.At3<RAYSHEAF_WORD(incoming)>(), f.At3<RAYSHEAF_SURFACE_WORD(normal)>());
    const V3 reflected = Schlick(f.At3<RAYSHEAF_SURFACE_WORD(specular)>(),
                                 f.At<RAYSHEAF_SURFACE_WORD(specular_edge)>(), cosine);
    const V3 coat = Schlick(f.At3<RAYSHEAF_SURFACE_WORD(coat)>(),
                            f.At<RAYSHEAF_SURFACE_WORD(coat_edge)>(), cosine);
    const V3 below{hn::Sub(one, coat.x), hn::Sub(one, coat.y), hn::Sub(one, coat.z)};
    const M mirror = hn::Lt(f.At<RAYSHEAF_SURFACE_WORD(roughness)>(), hn::Set(d, kMirrorRoughness));
    const M worth =
        hn::Ge(MaxOf(times(f.At3<RAYSHEAF_WORD(weight)>(), reflected)), hn::Set(d, kLeastWeight));
    const M reflects = hn::And(hn::And(is_there, is_lit), hn::And(traced, hn::And(mirror, worth)));
    const V3 diffuse = times(f.At3<RAYSHEAF_SURFACE_WORD(diffuse)>(), below);
    // The refracted part is 0; adding it turns -0 into 0, as in the scalar code.
    const V3 part = plus(select(reflects, diffuse, plus(diffuse, reflected)), {zero, zero, zero});
    const V3 lit = select(is_lit, plus(emission, times(part, sky)), emission);
    Give3(select(is_there, lit, sky), left, radiance + k);
    if (going_on != nullptr) GiveBytes(reflects, kReflects, left, going_on + k);
    const M glass = hn::And(is_there, hn::Gt(f.At<RAYSHEAF_SURFACE_WORD(transmission)>(), zero));
    const std::uint32_t there = left < kLightLanes ? (1u << left) - 1 : 0xffffu;
    odd[k / kLightLanes] |=
        static_cast<std::uint16_t>((bits_of(d, glass) & there) << k % kLightLanes);
  }
}

}  // namespace
}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(FindGlow);

void find_glow(View<const Fragment> fragments, const GlowLook& look, Vec3* radiance,
               std::uint8_t* going_on, std::uint16_t* odd) {
  HWY_DYNAMIC_DISPATCH(FindGlow)(fragments, look, radiance, going_on, odd);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
