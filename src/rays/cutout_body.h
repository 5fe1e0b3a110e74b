// Rays through what materials cut away (surface/cutout.h): whether something is there, and where a
// ray goes on. For the CPU's stages (render/frame/cutouts.h) and a device's.
#pragma once

#include "base/bits.h"
#include "rays/sample_body.h"
#include "raysheaf/types.h"
#include "surface/material_body.h"

namespace raysheaf {

/// Above 0 and below 1, of a ray whatever its interval.
RAYSHEAF_HD inline float chance_of(const Ray& ray, std::uint32_t triangle) {
  std::uint32_t seed = triangle;
  for (const Vec3 v : {ray.origin, ray.direction})
    for (int axis = 0; axis < 3; ++axis) seed = mixed_seed(seed, float_bits(component(v, axis)));
  return (static_cast<float>(seed >> 8) + 0.5f) * 0x1p-24f;
}

/// Whether there is nothing where the ray meets a triangle of the material. `alpha`: of the place;
/// `blends`: alpha may be a chance (`is_by_chance`).
RAYSHEAF_HD inline bool is_cut_away(const PlacedMaterial& material, float alpha, bool blends,
                                    const Ray& ray, std::uint32_t triangle) {
  return alpha <
         (is_by_chance(material, blends) ? chance_of(ray, triangle) : material.alpha_cutoff);
}

/// The next number above a finite one: where a ray goes on that met nothing at `t`.
RAYSHEAF_HD inline float just_behind(float t) {
  const std::uint32_t bits = float_bits(t);
  if (t == 0) return bits_float(1);
  return bits_float(t > 0 ? bits + 1 : bits - 1);
}

}  // namespace raysheaf
