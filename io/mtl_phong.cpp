#include "io/mtl_phong.h"

#include <algorithm>
#include <cmath>

namespace raysheaf::io {
namespace {

float fraction(float x) {
  return x > 0 ? std::min(x, 1.0f) : 0;
}
float positive(float x) {
  return x > 0 ? x : 0;
}
/// Negative components become 0.
Vec3 mtl_color(Vec3 rgb) {
  return {positive(rgb.x), positive(rgb.y), positive(rgb.z)};
}
void set_base(Vec3 rgb, Material& material) {
  material.base_color = {rgb.x, rgb.y, rgb.z, 1};
}

/// A mirror has a mirror illumination model or a very sharp highlight.
bool is_mirror(const MtlMaterial& m) {
  const float kd = largest_part(mtl_color(m.diffuse.value_or(Vec3{}))),
              ks = largest_part(mtl_specular(m));
  if (m.diffuse_map.is_named() || ks < 0.5f) return false;
  return ((m.illum == 3 || m.illum == 5) && ks > kd) || (m.shininess >= 500 && ks > 2 * kd);
}

/// The illumination models that stand for glass.
bool is_called_glass(const MtlMaterial& m) {
  return m.illum == 4 || m.illum == 6 || m.illum == 7 || m.illum == 9;
}

/// Programs that do not support Tf write white.
bool has_filter(const MtlMaterial& m) {
  const Vec3 filter = mtl_color(m.filter);
  return largest_part(filter) > 0 && !(filter.x == 1 && filter.y == 1 && filter.z == 1);
}

/// An emissive material is not constant: a constant colour leaves no room for emission.
bool is_constant(const MtlMaterial& m) {
  return m.illum == 0 && largest_part(mtl_color(m.emission)) == 0 && !m.emission_map.is_named();
}

/// The diffuse colour of the body. A black factor would hide the texture, so white replaces it.
/// Without either, the colour is the grey of faces without a material.
Vec3 body_color(const MtlMaterial& m) {
  const Vec3 kd = mtl_color(m.diffuse.value_or(Vec3{}));
  if (m.diffuse_map.is_named()) return largest_part(kd) == 0 ? Vec3{1, 1, 1} : kd;
  return m.diffuse ? kd : Vec3{0.8f, 0.8f, 0.8f};
}

float ior_of(const MtlMaterial& m) {
  return m.ior > 1 ? m.ior : 1.5f;
}

void make_glass(const MtlMaterial& m, Material& material) {
  const Vec3 filter = mtl_color(m.filter);
  const Vec3 tint = largest_part(filter) > 0 ? filter : Vec3{1, 1, 1};
  set_base({fraction(tint.x), fraction(tint.y), fraction(tint.z)}, material);
  material.transmission = is_called_glass(m) ? 1 : 1 - fraction(m.dissolve);
  material.ior = ior_of(m);
  material.roughness = 0;
}

/// The light that is not reflected splits: the part d reaches a body of colour Kd. The part 1 - d
/// passes through, tinted by Kd / k, where k is the largest component of Kd: a dark body does not
/// darken a thin pane. One base colour b and the transmission t have to express both: b (1 - t) = d
/// Kd and b t = (1 - d) Kd / k.
void make_tinted(const MtlMaterial& m, Material& material) {
  const Vec3 kd = body_color(m);
  const float k = largest_part(kd), d = fraction(m.dissolve), whole = 1 - d + d * k;
  const Vec3 tint = k > 0 ? Vec3{kd.x / k, kd.y / k, kd.z / k} : Vec3{1, 1, 1};
  set_base({tint.x * whole, tint.y * whole, tint.z * whole}, material);
  material.transmission = (1 - d) / whole;
  material.ior = ior_of(m);
  material.roughness = 0;
}

void make_mirror(const MtlMaterial& m, Material& material) {
  set_base(mtl_color(m.specular), material);
  material.metallic = 1;
  material.roughness = fraction(m.roughness);
}

void make_glossy(const MtlMaterial& m, Material& material) {
  const Vec3 ks = mtl_specular(m);
  set_base(body_color(m), material);
  material.base_color.w = fraction(m.dissolve);
  // Walter et al., Microfacet Models for Refraction (2007): converts Blinn's exponent to Beckmann's
  // width.
  material.roughness = std::sqrt(2 / (positive(m.shininess) + 2));
  const float strength = largest_part(ks);
  material.specular = fraction(strength);
  if (strength > 0) {
    material.specular_color = {ks.x / strength, ks.y / strength, ks.z / strength};
  }
  if (m.metallic > 0) material.metallic = fraction(m.metallic);
  if (m.roughness > 0) material.roughness = fraction(m.roughness);
}

}  // namespace

Vec3 mtl_specular(const MtlMaterial& m) {
  return m.illum == 0 || m.illum == 1 ? Vec3{} : mtl_color(m.specular);
}
float largest_part(Vec3 color) {
  return std::max({color.x, color.y, color.z});
}

MtlLook look_of(const MtlMaterial& m) {
  if (is_called_glass(m)) return MtlLook::kGlass;
  if (is_constant(m)) return MtlLook::kConstant;
  if (m.dissolve < 1 && m.ior > 1 && !m.alpha_map.is_named())
    return has_filter(m) ? MtlLook::kGlass : MtlLook::kTinted;
  return is_mirror(m) ? MtlLook::kMirror : MtlLook::kGlossy;
}

Material material_of(const MtlMaterial& m) {
  Material material;
  material.name = m.name;
  material.double_sided = true;
  material.emission = mtl_color(m.emission);
  switch (look_of(m)) {
    case MtlLook::kGlass:
      make_glass(m, material);
      break;
    case MtlLook::kTinted:
      make_tinted(m, material);
      break;
    case MtlLook::kMirror:
      make_mirror(m, material);
      break;
    case MtlLook::kConstant:
      material.unlit = true;
      [[fallthrough]];
    case MtlLook::kGlossy:
      make_glossy(m, material);
      break;
  }
  return material;
}

}  // namespace raysheaf::io
