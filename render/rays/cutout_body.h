// Rays through holes of materials (scene/cutout.h): whether a hit is in a hole, and where a ray
// continues. Used by the CPU's stages (render/frame/cutouts.h) and a device's.
#pragma once

#include "base/bits.h"
#include "raysheaf/types.h"
#include "render/rays/sample_body.h"
#include "render/surface/material_body.h"

namespace raysheaf {

/// A random number between 0 and 1, exclusive, that does not depend on the ray's interval.
RAYSHEAF_HD inline float chance_of(const Ray& ray, std::uint32_t triangle) {
  std::uint32_t seed = triangle;
  for (const Vec3 v : {ray.origin, ray.direction})
    for (int axis = 0; axis < 3; ++axis) seed = mixed_seed(seed, float_bits(component(v, axis)));
  return (static_cast<float>(seed >> 8) + 0.5f) * 0x1p-24f;
}

/// Whether the ray's hit with a triangle of the material is in a hole. `alpha`: at the hit;
/// `blends`: alpha may be a probability (`is_by_chance`).
RAYSHEAF_HD inline bool is_cut_away(const PlacedMaterial& material, float alpha, bool blends,
                                    const Ray& ray, std::uint32_t triangle) {
  return alpha <
         (is_by_chance(material, blends) ? chance_of(ray, triangle) : least_alpha(material));
}

/// The next number above a finite one: where a ray continues after a hole at `t`.
RAYSHEAF_HD inline float just_behind(float t) {
  const std::uint32_t bits = float_bits(t);
  if (t == 0) return bits_float(1);
  return bits_float(t > 0 ? bits + 1 : bits - 1);
}

}  // namespace raysheaf
