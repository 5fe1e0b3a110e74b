// `lit_by` for 16 fragments at a time: `reflectance` of shade_body.h, with the same operations in
// the same order. Compiled once for each SIMD target and chosen at run time (Google Highway).
#include "render/shade/point_shading.h"

#include <bit>

#include "render/shade/shade.h"
#include "render/shade/shade_body.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/shade/point_shading_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/rays/point_light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raysheaf::HWY_NAMESPACE {
namespace {

/// One side's half of Smith's masking: sqrt(c^2 (1 - a^2) + a^2).
HWY_INLINE V Masking(V cosine, V alpha2) {
  const V rest = hn::Sub(hn::Set(Floats(), 1.0f), alpha2);
  return hn::Sqrt(hn::Add(hn::Mul(hn::Mul(cosine, cosine), rest), alpha2));
}

void GatherShading(View<const Fragment> fragments, const Vec3* radiance, ShadingColumns* columns) {
  const Floats d;
  ShadingColumns& c = *columns;
  for (std::size_t k = 0; k < fragments.size; k += hn::Lanes(d)) {
    const FragmentLanes f(fragments, k);
    const V3 normal = f.At3<RAYSHEAF_SURFACE_WORD(normal)>();
    const V3 incoming = f.At3<RAYSHEAF_WORD(incoming)>();
    const V3 coat = f.At3<RAYSHEAF_SURFACE_WORD(coat)>();
    Store3(f.At3<RAYSHEAF_SURFACE_WORD(position)>(), c.position, k);
    Store3(normal, c.normal, k);
    Store3(incoming, c.incoming, k);
    Store3(f.At3<RAYSHEAF_SURFACE_WORD(diffuse)>(), c.diffuse, k);
    Store3(f.At3<RAYSHEAF_SURFACE_WORD(specular)>(), c.specular, k);
    Store3(coat, c.coat, k);
    Store3(Take3(radiance + k, fragments.size - k), c.radiance, k);
    const V cosine = CosArrival(incoming, normal);
    const V alpha = larger(f.At<RAYSHEAF_SURFACE_WORD(roughness)>(), hn::Set(d, kMirrorRoughness));
    const V once = hn::Mul(alpha, alpha), alpha2 = hn::Mul(once, once);
    hn::Store(cosine, d, c.cos_view + k);
    hn::Store(alpha2, d, c.alpha2 + k);
    hn::Store(Masking(cosine, alpha2), d, c.masking + k);
    const V coat_edge = f.At<RAYSHEAF_SURFACE_WORD(coat_edge)>();
    hn::Store(f.At<RAYSHEAF_SURFACE_WORD(specular_edge)>(), d, c.specular_edge + k);
    hn::Store(coat_edge, d, c.coat_edge + k);
    Store3(Schlick(coat, coat_edge, cosine), c.coat_view, k);
  }
}

void GiveRadiance(const ShadingColumns& c, View<Vec3> radiance) {
  for (std::size_t k = 0; k < radiance.size; k += hn::Lanes(Floats()))
    Give3(Load3(c.radiance, k), radiance.size - k, radiance.data + k);
}

/// Lanes whose visibility byte is `kVisible`.
HWY_INLINE M IsVisible(const std::uint8_t* visible) {
  const Floats d;
  const hn::RebindToSigned<Floats> ints;
  const hn::Rebind<std::uint8_t, Floats> bytes;
  const auto value = hn::PromoteTo(ints, hn::LoadU(bytes, visible));
  return hn::RebindMask(
      d, hn::Eq(value, hn::Set(ints, static_cast<std::int32_t>(Visibility::kVisible))));
}

/// `reflectance` from the lanes at `k`; lanes that are not `usual` need the scalar function.
HWY_INLINE V3 Reflectance(const ShadingColumns& c, std::size_t k, const V3& to_light, V n_l,
                          M* usual) {
  const Floats d;
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const V3 normal = Load3(c.normal, k), incoming = Load3(c.incoming, k);
  const V3 between = minus(to_light, incoming);
  const V size = hn::Sqrt(dot(between, between));
  *usual = hn::And(*usual, IsUsual(size));
  const V3 half = divided(between, size);
  const V n_h = Clamp(dot(normal, half), 0, 1), v_h = Clamp(hn::Neg(dot(incoming, half)), 0, 1);
  const V3 fresnel = Schlick(Load3(c.specular, k), hn::Load(d, c.specular_edge + k), v_h);
  const V3 coat_half = Schlick(Load3(c.coat, k), hn::Load(d, c.coat_edge + k), v_h);
  const V3 coat_view = Load3(c.coat_view, k);
  const V3 coat{larger(coat_half.x, coat_view.x), larger(coat_half.y, coat_view.y),
                larger(coat_half.z, coat_view.z)};
  const V n_v = hn::Load(d, c.cos_view + k), alpha2 = hn::Load(d, c.alpha2 + k);
  const V lobe = hn::Add(hn::Mul(hn::Mul(n_h, n_h), hn::Sub(alpha2, one)), one);
  const V distribution = hn::Div(alpha2, hn::Mul(hn::Mul(hn::Set(d, kPi), lobe), lobe));
  const V masking =
      hn::Add(hn::Mul(n_l, hn::Load(d, c.masking + k)), hn::Mul(n_v, Masking(n_l, alpha2)));
  const V highlight = hn::IfThenElseZero(hn::Gt(masking, zero),
                                         hn::Div(hn::Mul(hn::Set(d, 0.5f), distribution), masking));
  const V3 rest{hn::Sub(one, coat.x), hn::Sub(one, coat.y), hn::Sub(one, coat.z)};
  const V3 below = times(times(Load3(c.diffuse, k), rest), hn::Set(d, 1 / kPi));
  return times(plus(below, times(fresnel, highlight)), n_l);
}

void AddPointLight(const PlacedLight& light, View<const Fragment> fragments,
                   const std::uint8_t* visible, ShadingColumns* columns) {
  const Floats d;
  ShadingColumns& c = *columns;
  for (std::size_t k = 0; k < fragments.size; k += hn::Lanes(d)) {
    const M shown = IsVisible(visible + k);
    if (hn::AllFalse(d, shown)) continue;
    const PointSeen seen = SeePoint(light, Load3(c.position, k));
    const V n_l = dot(Load3(c.normal, k), seen.to_light);
    M usual = seen.usual;
    const V3 sent = times(Reflectance(c, k, seen.to_light, n_l, &usual), seen.irradiance);
    const M faces = hn::Gt(n_l, hn::Zero(d)), adds = hn::And(shown, usual);
    const V3 given{hn::IfThenElseZero(faces, sent.x), hn::IfThenElseZero(faces, sent.y),
                   hn::IfThenElseZero(faces, sent.z)};
    const V3 before = Load3(c.radiance, k), after = plus(before, given);
    Store3(select(adds, after, before), c.radiance, k);
    for (std::uint32_t odd = bits_of(d, shown) & ~bits_of(d, usual); odd != 0; odd &= odd - 1) {
      const std::size_t i = k + static_cast<std::size_t>(std::countr_zero(odd));
      const Fragment& f = fragments[i];
      const Vec3 one = lit_by(f, sample_point(light, f.surface.position));
      c.radiance[0][i] += one.x;
      c.radiance[1][i] += one.y;
      c.radiance[2][i] += one.z;
    }
  }
}

}  // namespace
}  // namespace raysheaf::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raysheaf {

HWY_EXPORT(GatherShading);
HWY_EXPORT(GiveRadiance);
HWY_EXPORT(AddPointLight);

void gather_shading(View<const Fragment> fragments, const Vec3* radiance, ShadingColumns* columns) {
  HWY_DYNAMIC_DISPATCH(GatherShading)(fragments, radiance, columns);
}

void give_radiance(const ShadingColumns& columns, View<Vec3> radiance) {
  HWY_DYNAMIC_DISPATCH(GiveRadiance)(columns, radiance);
}

void add_point_light(const PlacedLight& light, View<const Fragment> fragments,
                     const std::uint8_t* visible, ShadingColumns* columns) {
  HWY_DYNAMIC_DISPATCH(AddPointLight)(light, fragments, visible, columns);
}

}  // namespace raysheaf
#endif  // HWY_ONCE
