// The radiance that leaves one fragment towards the eye: emission, a uniform sky, and the visible
// lights.
#pragma once

#include <cmath>

#include "render/rays/light_body.h"
#include "render/rays/scatter_body.h"
#include "render/surface/environment_body.h"
#include "render/surface/studio_room.h"

namespace raysheaf {

inline constexpr float kPi = 3.14159265358979f;

/// Lambert below a GGX highlight (B. Walter et al., "Microfacet Models for Refraction", EGSR 2007;
/// height-correlated Smith shadowing as in Heitz 2014), times the cosine. Mirrors keep a small
/// highlight, so that lights are visible in them.
RAYSHEAF_HD inline Vec3 reflectance(const Fragment& f, Vec3 to_light) {
  const Surface& s = f.surface;
  const float n_l = dot(s.normal, to_light), n_v = cos_arrival(f);
  const Vec3 half = normalized(to_light - f.incoming, s.normal);
  const float n_h = clamp(dot(s.normal, half), 0, 1), v_h = clamp(-dot(f.incoming, half), 0, 1);
  const Vec3 fresnel = fresnel_schlick(s.specular, s.specular_edge, v_h);
  // At grazing views the highlight takes more light than its own Fresnel term.
  const Vec3 coat =
      max(fresnel_schlick(s.coat, s.coat_edge, v_h), fresnel_schlick(s.coat, s.coat_edge, n_v));
  const float smoothest = s.roughness > kMirrorRoughness ? s.roughness : kMirrorRoughness;
  const float alpha = smoothest * smoothest, a2 = alpha * alpha;
  const float lobe = n_h * n_h * (a2 - 1) + 1;
  const float distribution = a2 / (kPi * lobe * lobe);
  const float masking =
      n_l * std::sqrt(n_v * n_v * (1 - a2) + a2) + n_v * std::sqrt(n_l * n_l * (1 - a2) + a2);
  const float highlight = masking > 0 ? 0.5f * distribution / masking : 0;
  const Vec3 below = s.diffuse * (Vec3{1, 1, 1} - coat) * (1 / kPi);
  return (below + fresnel * highlight) * n_l;
}

/// The light of a light source that the fragment reflects towards the eye if nothing is between
/// them.
RAYSHEAF_HD inline Vec3 lit_by(const Fragment& f, const LightSample& sample) {
  if (!(dot(f.surface.normal, sample.to_light) > 0)) return {0, 0, 0};
  return reflectance(f, sample.to_light) * sample.irradiance;
}

/// The luminance of a white surface if nothing is between it and the light.
RAYSHEAF_HD inline float unoccluded(const Fragment& f, const LightSample& sample) {
  const float cosine = dot(f.surface.normal, sample.to_light);
  return cosine > 0 ? luminance(sample.irradiance) * cosine / kPi : 0;
}

/// Emission and the sky. `traced`: bits (`bit_of`) of the rays that add their part instead.
RAYSHEAF_HD inline Vec3 glow(const Fragment& f, const Scattering& s, Vec3 sky,
                             std::uint32_t traced) {
  if (f.surface.unlit) return f.surface.emission;
  Vec3 part = f.surface.diffuse * s.diffuse_part;
  if ((traced & kReflects) == 0) part += s.reflected_part;
  if ((traced & kRefracts) == 0) part += s.refracted_part;
  return f.surface.emission + part * sky;
}

/// The difference that the studio's room makes to `glow`: where no rays are traced, reflections and
/// refractions show it instead of the sky.
RAYSHEAF_HD inline Vec3 room_glow(const Fragment& f, const Scattering& s, Vec3 sky,
                                  const StudioRoom& room, std::uint32_t traced) {
  if (f.surface.unlit) return {0, 0, 0};
  Vec3 sum{0, 0, 0};
  if ((traced & kReflects) == 0 && max_component(s.reflected_part) > 0) {
    const Vec3 direction = s.mirror ? s.reflection : mirror_direction(f);
    const float roughness = s.mirror ? 0 : f.surface.roughness;
    sum += s.reflected_part * (studio_radiance(room, direction, roughness) - sky);
  }
  if ((traced & kRefracts) == 0 && max_component(s.refracted_part) > 0)
    sum += s.refracted_part * (studio_radiance(room, s.refraction, 0) - sky);
  return sum;
}

/// The parts of the environment in a mirror or glass for which no rays are traced.
RAYSHEAF_HD inline Vec3 environment_glow(const Fragment& f, const Scattering& s,
                                         const EnvironmentView& sky, std::uint32_t traced) {
  if (f.surface.unlit || !s.mirror) return {0, 0, 0};
  Vec3 sum{0, 0, 0};
  if ((traced & kReflects) == 0) sum += s.reflected_part * environment_radiance(sky, s.reflection);
  if ((traced & kRefracts) == 0 && max_component(s.refracted_part) > 0)
    sum += s.refracted_part * environment_radiance(sky, s.refraction);
  return sum;
}

}  // namespace raysheaf
