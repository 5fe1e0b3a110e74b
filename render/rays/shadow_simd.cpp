// Makes shadow rays of point lights, 16 fragments at a time: `faces_light` and `shadow_ray` of
// shadow_body.h, with the same operations in the same order. Compiled once for each SIMD target and
// chosen at run time (Google Highway).
#include <bit>
#include <cstddef>
#include <cstring>

#include "render/rays/shadow_body.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/rays/shadow_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/rays/point_light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {

void GatherShadowColumns(View<const Fragment> fragments, ShadowColumns* columns) {
  const Floats d;
  ShadowColumns& c = *columns;
  std::memset(c.lit, 0, sizeof c.lit);
  for (std::size_t k = 0; k < fragments.size; k += hn::Lanes(d)) {
    const FragmentLanes f(fragments, k);
    Store3(f.At3<RAYSHEAF_SURFACE_WORD(position)>(), c.position, k);
    Store3(f.At3<RAYSHEAF_SURFACE_WORD(normal)>(), c.normal, k);
    Store3(f.At3<RAYSHEAF_SURFACE_WORD(geometric_normal)>(), c.outward, k);
    hn::Store(f.At<RAYSHEAF_SURFACE_WORD(clearance)>(), d, c.clearance + k);
    const M lit = hn::And(HasTriangle(f.At<RAYSHEAF_WORD(triangle)>()),
                          IsLit(f.At<RAYSHEAF_SURFACE_WORD(unlit)>()));
    const std::size_t left = fragments.size - k;
    const std::uint32_t there = left < kLightLanes ? (1u << left) - 1 : 0xffffu;
    c.lit[k / kLightLanes] |=
        static_cast<std::uint16_t>((bits_of(d, lit) & there) << k % kLightLanes);
  }
}

std::uint32_t FindFacing(const ShadowColumns& c, const PlacedLight& light,
                         View<const Fragment> fragments, std::uint16_t* facing) {
  const Floats d;
  const V zero = hn::Zero(d);
  std::uint32_t count = 0;
  for (std::size_t group = 0; group * kLightLanes < fragments.size; ++group) {
    std::uint32_t faces = 0, usual = 0;
    for (std::size_t lane = 0; lane < kLightLanes; lane += hn::Lanes(d)) {
      const std::size_t k = group * kLightLanes + lane;
      const PointSeen seen = SeePoint(light, Load3(c.position, k));
      const M lit = hn::And(hn::Gt(dot(Load3(c.normal, k), seen.to_light), zero),
                            hn::Gt(MaxOf(seen.irradiance), zero));
      faces |= bits_of(d, hn::And(lit, seen.usual)) << lane;
      usual |= bits_of(d, seen.usual) << lane;
    }
    faces &= c.lit[group];
    for (std::uint32_t rest = c.lit[group] & ~usual; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
      const Fragment& f = fragments[group * kLightLanes + lane];
      if (faces_light(f, sample_point(light, f.surface.position))) faces |= 1u << lane;
    }
    facing[group] = static_cast<std::uint16_t>(faces);
    count += static_cast<std::uint32_t>(std::popcount(faces));
  }
  return count;
}

void MakePointRays(const ShadowColumns& c, const PlacedLight& light, View<const Fragment> fragments,
                   const std::uint16_t* facing, Ray* rays) {
  const Floats d;
  const V3 origin = Splat(light.position);
  // Half of a ray, copied as a whole.
  struct alignas(16) HalfRay {
    Vec3 xyz;
    float t;
  };
  static_assert(sizeof(Ray) == 2 * sizeof(HalfRay));
  const HalfRay first{light.position, 0};
  alignas(64) HalfRay second[kLightLanes];
  for (std::size_t group = 0; group * kLightLanes < fragments.size; ++group) {
    if (facing[group] == 0) continue;
    std::uint32_t usual = 0;
    for (std::size_t lane = 0; lane < kLightLanes; lane += hn::Lanes(d)) {
      const std::size_t k = group * kLightLanes + lane;
      const V3 position = Load3(c.position, k), outward = Load3(c.outward, k);
      const PointSeen seen = SeePoint(light, position);
      const V step = hn::Add(hn::Load(d, c.clearance + k),
                             hn::Mul(hn::Set(d, kOffsetRoundings * kUnitRoundoff), seen.distance));
      const M inward = hn::Lt(dot(seen.to_light, outward), hn::Zero(d));
      const V3 target = plus(position, times(outward, hn::IfThenElse(inward, hn::Neg(step), step)));
      const V3 along = minus(target, origin);
      hn::StoreInterleaved4(along.x, along.y, along.z, hn::Set(d, 1.0f), d, &second[lane].xyz.x);
      usual |= bits_of(d, seen.usual) << lane;
    }
    for (std::uint32_t rest = facing[group]; rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(rest));
      if (HWY_LIKELY((usual >> lane & 1) != 0)) {
        std::memcpy(static_cast<void*>(rays), &first, sizeof first);
        std::memcpy(reinterpret_cast<std::byte*>(rays) + sizeof first, second + lane, sizeof first);
        ++rays;
        continue;
      }
      const Fragment& f = fragments[group * kLightLanes + lane];
      *rays++ = shadow_ray(f, sample_point(light, f.surface.position), {});
    }
  }
}

}  // namespace
}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(GatherShadowColumns);
HWY_EXPORT(FindFacing);
HWY_EXPORT(MakePointRays);

void gather_shadow_columns(View<const Fragment> fragments, ShadowColumns* columns) {
  HWY_DYNAMIC_DISPATCH(GatherShadowColumns)(fragments, columns);
}

std::uint32_t find_facing(const ShadowColumns& columns, const PlacedLight& light,
                          View<const Fragment> fragments, std::uint16_t* facing) {
  return HWY_DYNAMIC_DISPATCH(FindFacing)(columns, light, fragments, facing);
}

void make_point_rays(const ShadowColumns& columns, const PlacedLight& light,
                     View<const Fragment> fragments, const std::uint16_t* facing, Ray* rays) {
  HWY_DYNAMIC_DISPATCH(MakePointRays)(columns, light, fragments, facing, rays);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
