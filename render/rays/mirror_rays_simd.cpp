// Makes 16 mirror rays at a time: `scattered_parts`, `mirror_direction` and `offset_point`, with
// the same operations in the same order. Compiled once for each SIMD target and chosen at run time
// (Google Highway).
#include "render/rays/mirror_rays.h"

#include <algorithm>
#include <limits>

#include "render/rays/offset_body.h"
#include "render/rays/scatter_body.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/rays/mirror_rays_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/rays/fragment_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {

/// SIMD version of `reflected`.
HWY_INLINE V3 Reflected(const V3& incoming, const V3& normal) {
  const V twice = hn::Mul(hn::Set(Floats(), 2.0f), dot(incoming, normal));
  return minus(incoming, times(normal, twice));
}

/// Stores both halves of `count` rays from `origin`.
HWY_INLINE void GiveRays(const V3& origin, const V3& direction, std::size_t count, Ray* to) {
  const Floats d;
  static_assert(sizeof(Ray) == 8 * sizeof(float));
  alignas(64) float first[4 * kLightLanes], second[4 * kLightLanes];
  hn::StoreInterleaved4(origin.x, origin.y, origin.z, hn::Zero(d), d, first);
  hn::StoreInterleaved4(direction.x, direction.y, direction.z,
                        hn::Set(d, std::numeric_limits<float>::infinity()), d, second);
  constexpr std::size_t kHalf = sizeof(Ray) / 2;
  for (std::size_t i = 0; i < std::min(count, hn::Lanes(d)); ++i) {
    auto* const bytes = reinterpret_cast<std::byte*>(to + i);
    std::memcpy(bytes, first + 4 * i, kHalf);
    std::memcpy(bytes + kHalf, second + 4 * i, kHalf);
  }
}

void MakeMirrorRays(View<const Fragment> fragments, View<const std::uint32_t> slots, Ray* rays,
                    Vec3* weights, std::uint16_t* odd) {
  const Floats d;
  const V zero = hn::Zero(d);
  std::fill_n(odd, (slots.size + kLightLanes - 1) / kLightLanes, std::uint16_t{0});
  for (std::size_t k = 0; k < slots.size; k += hn::Lanes(d)) {
    const ListedLanes f(fragments, slots, k);
    const std::size_t left = slots.size - k;
    const V3 incoming = f.At3<RAYSHEAF_WORD(incoming)>();
    const V3 normal = f.At3<RAYSHEAF_SURFACE_WORD(normal)>();
    const V3 outward = f.At3<RAYSHEAF_SURFACE_WORD(geometric_normal)>();
    const V3 part =
        Schlick(f.At3<RAYSHEAF_SURFACE_WORD(specular)>(),
                f.At<RAYSHEAF_SURFACE_WORD(specular_edge)>(), CosArrival(incoming, normal));
    Give3(times(f.At3<RAYSHEAF_WORD(weight)>(), part), left, weights + k);
    const V3 smooth = Reflected(incoming, normal);
    const M leaves = hn::Gt(dot(smooth, outward), zero);
    const V3 mirrored = select(leaves, smooth, Reflected(incoming, outward));
    const V size = hn::Sqrt(dot(mirrored, mirrored));
    const V3 direction = divided(mirrored, size);
    const V step = f.At<RAYSHEAF_SURFACE_WORD(clearance)>();
    const M inward = hn::Lt(dot(direction, outward), zero);
    const V3 origin = plus(f.At3<RAYSHEAF_SURFACE_WORD(position)>(),
                           times(outward, hn::IfThenElse(inward, hn::Neg(step), step)));
    GiveRays(origin, direction, left, rays + k);
    const M opaque = hn::Not(hn::Gt(f.At<RAYSHEAF_SURFACE_WORD(transmission)>(), zero));
    const M usual =
        hn::And(hn::And(IsUsual(size), opaque), IsLit(f.At<RAYSHEAF_SURFACE_WORD(unlit)>()));
    const std::uint32_t there = left < kLightLanes ? (1u << left) - 1 : 0xffffu;
    const std::uint32_t lanes = (1u << hn::Lanes(d)) - 1;
    odd[k / kLightLanes] |=
        static_cast<std::uint16_t>((~bits_of(d, usual) & there & lanes) << k % kLightLanes);
  }
}

}  // namespace
}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(MakeMirrorRays);

void make_mirror_rays(View<const Fragment> fragments, View<const std::uint32_t> slots, Ray* rays,
                      Vec3* weights, std::uint16_t* odd) {
  HWY_DYNAMIC_DISPATCH(MakeMirrorRays)(fragments, slots, rays, weights, odd);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
