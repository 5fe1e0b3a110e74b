// Reflection and refraction at mirrors and glass: the directions of the light and its parts.
#pragma once

#include <cmath>

#include "raysheaf/statistics.h"
#include "render/rays/fragment.h"

namespace raysheaf {

/// Smoother surfaces reflect like mirrors; others only show highlights of the lights.
inline constexpr float kMirrorRoughness = 0.1f;
/// Rays that would add less than this fraction of their radiance to a pixel are not traced.
inline constexpr float kLeastWeight = 1.0f / 1024;

/// Fresnel's equations for unpolarised light (Fresnel 1823). `cos_in` in [0, 1]; `eta`: the index
/// of refraction of the side to which the light goes over that of the side from which it comes. 1
/// at total internal reflection.
RAYSHEAF_HD inline float fresnel_dielectric(float cos_in, float eta) {
  const float sin2_out = (1 - cos_in * cos_in) / (eta * eta);
  if (sin2_out >= 1) return 1;
  const float cos_out = std::sqrt(1 - sin2_out);
  const float parallel = (eta * cos_in - cos_out) / (eta * cos_in + cos_out);
  const float across = (cos_in - eta * cos_out) / (cos_in + eta * cos_out);
  return (parallel * parallel + across * across) * 0.5f;
}

/// C. Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994, with the
/// reflectance at grazing angles, which is 1 except with KHR_materials_specular. If nothing is
/// reflected along the normal, nothing is at grazing angles.
RAYSHEAF_HD inline Vec3 fresnel_schlick(Vec3 at_normal, float at_edge, float cos_in) {
  if (max_component(at_normal) <= 0) return {0, 0, 0};
  const float m = clamp(1 - cos_in, 0, 1), m2 = m * m;
  return at_normal + (Vec3{at_edge, at_edge, at_edge} - at_normal) * (m2 * m2 * m);
}

RAYSHEAF_HD inline Vec3 reflected(Vec3 incoming, Vec3 normal) {
  return incoming - normal * (2 * dot(incoming, normal));
}

struct Scattering {
  Vec3 reflection, refraction;  ///< unit directions, of a mirror, and of glass
  Vec3 reflected_part{0, 0, 0}, refracted_part{0, 0, 0};  ///< of the radiance along them
  Vec3 diffuse_part{1, 1, 1};  ///< what the specular layer transmits to the body below
  bool mirror = false;         ///< smooth enough to trace its reflection
};

/// The cosine between the arriving ray and the shading normal, slightly above 0. If the shading
/// normal points away from the ray, the absolute value is used (S. Lagarde, C. de Rousiers, "Moving
/// Frostbite to Physically Based Rendering", SIGGRAPH 2014, section 3.1): with 0, Schlick's power
/// would turn such a surface into a mirror.
RAYSHEAF_HD inline float cos_arrival(const Fragment& f) {
  return clamp(std::fabs(dot(f.incoming, f.surface.normal)), 1e-4f, 1);
}

/// A mirror direction that leaves to the ray's side: by the shading normal, or by the geometric one
/// if the shading normal would reflect into the surface.
RAYSHEAF_HD inline Vec3 mirror_direction(const Fragment& f) {
  const Vec3 smooth = reflected(f.incoming, f.surface.normal);
  if (dot(smooth, f.surface.geometric_normal) > 0) return normalized(smooth);
  return normalized(reflected(f.incoming, f.surface.geometric_normal));
}

/// Whether a ray comes from outside. A thin sheet has no inside: both of its sides are outside.
RAYSHEAF_HD inline bool meets_outside(const Surface& surface) {
  return surface.front || surface.thin;
}

/// Glass: Fresnel's split; the colour applies where light enters. The rise of the exact reflectance
/// from its value along the normal to 1 replaces Schlick's power, so that tinted, weakened and
/// partly metallic surfaces rise in the same way; from inside, where it ends in total reflection,
/// to 1.
RAYSHEAF_HD inline void split_at_glass(const Surface& surface, float cos_in, Scattering* s) {
  const bool outside = meets_outside(surface);
  const float eta = outside ? surface.ior : 1 / surface.ior;
  const float along_normal = fresnel_dielectric(1, eta);
  const float exact = fresnel_dielectric(cos_in, eta);
  const float rise =
      along_normal < 1 ? clamp((exact - along_normal) / (1 - along_normal), 0, 1) : 1;
  const Vec3 white{1, 1, 1};
  const Vec3 tint = outside ? surface.transmission_color : white;
  const Vec3 specular_edge = outside ? white * surface.specular_edge : white;
  const Vec3 coat_edge = outside ? white * surface.coat_edge : white;
  s->reflected_part = lerp(surface.specular, specular_edge, rise);
  s->diffuse_part = white - lerp(surface.coat, coat_edge, rise);
  s->refracted_part = tint * s->diffuse_part * surface.transmission;
  s->mirror = true;
}

/// Snell's law; zero if all light is reflected. Straight on through a thin sheet, which refracts
/// light back on leaving.
RAYSHEAF_HD inline Vec3 refracted(const Fragment& f, float cos_in) {
  const Surface& surface = f.surface;
  if (surface.thin) return f.incoming;
  const float eta = surface.front ? surface.ior : 1 / surface.ior;
  const float sin2_out = (1 - cos_in * cos_in) / (eta * eta);
  if (sin2_out >= 1) return {0, 0, 0};
  const float cos_out = std::sqrt(1 - sin2_out);
  const Vec3 direction =
      normalized(f.incoming * (1 / eta) + surface.normal * (cos_in / eta - cos_out));
  return dot(direction, surface.geometric_normal) >= 0 ? f.incoming : direction;
}

/// The parts of the light, without the directions.
RAYSHEAF_HD inline Scattering scattered_parts(const Fragment& f) {
  const Surface& surface = f.surface;
  Scattering s;
  const float cos_in = cos_arrival(f);
  if (surface.transmission > 0) {
    split_at_glass(surface, cos_in, &s);
  } else {
    s.reflected_part = fresnel_schlick(surface.specular, surface.specular_edge, cos_in);
    s.diffuse_part = Vec3{1, 1, 1} - fresnel_schlick(surface.coat, surface.coat_edge, cos_in);
    s.mirror = surface.roughness < kMirrorRoughness;
  }
  if (surface.unlit) s.reflected_part = s.refracted_part = s.diffuse_part = {0, 0, 0};
  return s;
}

/// Snell's law, Fresnel's split, and the parts of the light (T. Whitted, "An Improved Illumination
/// Model for Shaded Display", 1980). The parts sum to at most 1.
RAYSHEAF_HD inline Scattering scatter(const Fragment& f) {
  Scattering s = scattered_parts(f);
  if (f.surface.transmission > 0) s.refraction = refracted(f, cos_arrival(f));
  if (s.mirror) s.reflection = mirror_direction(f);
  return s;
}

RAYSHEAF_HD inline bool worth_tracing(Vec3 weight) {
  return max_component(weight) >= kLeastWeight;
}

/// A ray that continues from a fragment, and the part of its radiance that arrives there.
struct Bounce {
  Vec3 direction;
  Vec3 part;
};

/// `kind`: one that `rays_of` has.
RAYSHEAF_HD inline Bounce bounce(const Fragment& f, RayKind kind) {
  const Scattering s = scattered_parts(f);
  switch (kind) {
    case RayKind::kReflection:
      return {mirror_direction(f), s.reflected_part};
    case RayKind::kRefraction:
      return {refracted(f, cos_arrival(f)), s.refracted_part};
    case RayKind::kPrimary:
    case RayKind::kShadow:
    case RayKind::kAmbientOcclusion:
    case RayKind::kCount:
      break;
  }
  return {};
}

/// The rays that continue from a fragment, one bit for each kind.
[[nodiscard]] RAYSHEAF_HD constexpr std::uint8_t bit_of(RayKind kind) {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(kind));
}
inline constexpr std::uint8_t kReflects = bit_of(RayKind::kReflection);
inline constexpr std::uint8_t kRefracts = bit_of(RayKind::kRefraction);
inline constexpr std::uint8_t kAllBounces = kReflects | kRefracts;

RAYSHEAF_HD inline std::uint8_t rays_of(const Fragment& f, const Scattering& s) {
  const bool reflects = s.mirror && worth_tracing(f.weight * s.reflected_part);
  const bool refracts = worth_tracing(f.weight * s.refracted_part);
  return static_cast<std::uint8_t>((reflects ? kReflects : 0) | (refracts ? kRefracts : 0));
}

}  // namespace raysheaf
