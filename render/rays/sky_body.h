// The directions in which a fragment samples an environment.
//
// There are two rays per fragment: one is chosen in proportion to the map's brightness, one in
// proportion to the surface's reflectance. Each is weighted by the probabilities with which both
// strategies choose its direction (the balance heuristic of E. Veach, L. Guibas, "Optimally
// Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH 1995), so that both a small
// sun on matte stone and a uniform sky in dull metal have little noise.
#pragma once

#include <cmath>

#include "render/rays/light_body.h"
#include "render/rays/scatter_body.h"
#include "render/surface/environment_body.h"

namespace raysheaf {

/// 0: by the map; 1: by the surface.
inline constexpr std::uint32_t kSkyStrategies = 2;

/// The reflection lobes of an opaque surface that is not a mirror: Lambert's lobe, and that of GGX
/// for the arriving ray (E. Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4),
/// 2018). In the frame of the shading normal.
struct SurfaceLobes {
  Vec3 normal;
  Tangents side;
  Vec3 view;         ///< to the eye, along (s, t, normal); above the surface
  float alpha = 1;   ///< of GGX
  float matte = 0;   ///< reflectance of Lambert's lobe, as luminance
  float glossy = 0;  ///< of the glossy lobe
  Vec3 matte_color, glossy_color;
};

RAYSHEAF_HD inline SurfaceLobes surface_lobes(const Fragment& f) {
  const Scattering s = scatter(f);
  SurfaceLobes lobes;
  lobes.normal = f.surface.normal;
  lobes.side = tangents(lobes.normal);
  const Vec3 to_eye = -f.incoming;
  lobes.view = normalized({dot(to_eye, lobes.side.s), dot(to_eye, lobes.side.t),
                           std::fmax(dot(to_eye, lobes.normal), 1e-3f)});
  lobes.alpha = f.surface.roughness * f.surface.roughness;
  lobes.matte_color = f.surface.diffuse * s.diffuse_part;
  // Mirrors and glass have separate rays for their reflections.
  lobes.glossy_color = s.mirror || f.surface.unlit ? Vec3{0, 0, 0} : s.reflected_part;
  lobes.matte = f.surface.unlit ? 0 : luminance(lobes.matte_color);
  lobes.glossy = luminance(lobes.glossy_color);
  return lobes;
}

/// The probability per steradian of mirror directions at visible normals: D G1 / (4 n.v).
RAYSHEAF_HD inline float glossy_density(const SurfaceLobes& lobes, Vec3 to_light) {
  const Vec3 light{dot(to_light, lobes.side.s), dot(to_light, lobes.side.t),
                   dot(to_light, lobes.normal)};
  const Vec3 half = normalized(light + lobes.view);
  if (!(light.z > 0 && half.z > 0)) return 0;
  const float a2 = lobes.alpha * lobes.alpha, n_v = lobes.view.z;
  const float lobe = half.z * half.z * (a2 - 1) + 1;
  const float distribution = a2 / (3.14159265f * lobe * lobe);
  const float visible = 2 * n_v / (n_v + std::sqrt(a2 + (1 - a2) * n_v * n_v));
  return distribution * visible / (4 * n_v);
}

/// A mirror direction at a visible normal, in world space (Heitz 2018, section 3.2: stretching the
/// hemisphere makes all normals equally likely, and a point of the disc seen by `view` selects
/// one).
RAYSHEAF_HD inline Vec3 glossy_direction(const SurfaceLobes& lobes, Vec2 chosen) {
  const float a = lobes.alpha;
  const Vec3 v = normalized({a * lobes.view.x, a * lobes.view.y, lobes.view.z});
  const float level = std::sqrt(v.x * v.x + v.y * v.y);
  const Vec3 first = level > 0 ? Vec3{-v.y / level, v.x / level, 0} : Vec3{1, 0, 0};
  const Vec3 second = cross(v, first);
  const float radius = std::sqrt(chosen.x);
  const Vec2 around = on_circle(chosen.y);
  const float x = radius * around.x;
  // The part of the disc beyond the horizon shows a half ellipse.
  const float s = 0.5f * (1 + v.z), edge = std::sqrt(clamp(1 - x * x, 0, 1));
  const float y = (1 - s) * edge + s * (radius * around.y);
  const float z = std::sqrt(clamp(1 - x * x - y * y, 0, 1));
  const Vec3 alike = first * x + second * y + v * z;
  const Vec3 half = normalized({a * alike.x, a * alike.y, std::fmax(alike.z, 1e-6f)});
  const Vec3 light = half * (2 * dot(lobes.view, half)) - lobes.view;
  return lobes.side.s * light.x + lobes.side.t * light.y + lobes.normal * light.z;
}

/// Lambert's lobe: a point of the disc below, lifted to the hemisphere.
RAYSHEAF_HD inline Vec3 matte_direction(const SurfaceLobes& lobes, Vec2 chosen) {
  const float radius = std::sqrt(chosen.x);
  const Vec2 around = on_circle(chosen.y);
  const float height = std::sqrt(clamp(1 - chosen.x, 0, 1));
  return lobes.side.s * (radius * around.x) + lobes.side.t * (radius * around.y) +
         lobes.normal * height;
}

/// The probability density of `surface_direction`. 0 if the surface reflects nothing.
RAYSHEAF_HD inline float surface_density(const SurfaceLobes& lobes, Vec3 to_light) {
  const float all = lobes.matte + lobes.glossy, cosine = dot(lobes.normal, to_light);
  if (!(all > 0 && cosine > 0)) return 0;
  const float glossy = lobes.glossy > 0 ? lobes.glossy * glossy_density(lobes, to_light) : 0;
  return (lobes.matte * cosine * 0.318309886f + glossy) / all;
}

/// Chooses one of the lobes in proportion to its reflectance.
RAYSHEAF_HD inline Vec3 surface_direction(const SurfaceLobes& lobes, Vec2 chosen) {
  const float all = lobes.matte + lobes.glossy, matte = all > 0 ? lobes.matte / all : 1;
  if (chosen.x < matte) return matte_direction(lobes, {chosen.x / matte, chosen.y});
  return glossy_direction(lobes, {clamp((chosen.x - matte) / (1 - matte), 0, 1), chosen.y});
}

/// The choice of `strategy`, as light from infinitely far: its irradiance on a surface that faces
/// it is the radiance over both strategies' densities. It is random even with a single sample,
/// because no direction is representative.
RAYSHEAF_HD inline LightSample choose_in_sky(const Fragment& f, const EnvironmentView& sky,
                                             std::uint32_t strategy, SampleOf sample) {
  LightSample light{{0, 0, 1}, std::numeric_limits<float>::infinity(), {0, 0, 0}, {0, 0, 0}};
  const SurfaceLobes lobes = surface_lobes(f);
  if (!(lobes.matte + lobes.glossy > 0)) return light;
  const std::uint32_t seed = choice_seed(Choice::kSky, f.pixel, f.path, strategy);
  const Vec2 chosen = sample_pair({sample.index, 2}, seed);
  light.to_light = normalized(strategy == 0 ? choose_direction(sky, chosen).direction
                                            : surface_direction(lobes, chosen));
  const float density =
      direction_density(sky, light.to_light) + surface_density(lobes, light.to_light);
  if (!(density > 0)) return light;
  light.irradiance = environment_radiance(sky, light.to_light) / density;
  return light;
}

/// The reflected part of this light towards the eye. A uniform sky gives the result of `glow`
/// without rays, except for the part of the glossy lobe that points into the surface.
RAYSHEAF_HD inline Vec3 lit_by_sky(const Fragment& f, const LightSample& light) {
  const SurfaceLobes lobes = surface_lobes(f);
  const float cosine = dot(lobes.normal, light.to_light);
  if (!(cosine > 0)) return {0, 0, 0};
  Vec3 part = lobes.matte_color * (cosine * 0.318309886f);
  if (lobes.glossy > 0) part += lobes.glossy_color * glossy_density(lobes, light.to_light);
  return part * light.irradiance;
}

}  // namespace raysheaf
