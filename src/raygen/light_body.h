// Lights as fragments see them (KHR_lights_punctual).
#pragma once

#include <cmath>

#include "base/vec.h"
#include "raysheaf/scene_description.h"

namespace raysheaf {

struct LightSample {
  Vec3 to_light;       ///< unit
  float distance = 0;  ///< infinite for directional lights
  Vec3 irradiance;     ///< on a surface that faces the light; black where the light does not reach
};

/// The part of a light's intensity that its range and its cone leave (the extension's own
/// recommendation).
RAYSHEAF_HD inline float light_window(const Light& light, Vec3 from_light, float distance) {
  float window = 1;
  if (std::isfinite(light.range)) {
    const float ratio = distance / light.range;
    window = clamp(1 - ratio * ratio * ratio * ratio, 0, 1);
  }
  if (light.type == Light::Type::kSpot) {
    const float cos_outer = std::cos(light.outer_angle), cos_inner = std::cos(light.inner_angle);
    const float span = std::fmax(cos_inner - cos_outer, 1e-3f);
    const float inside = clamp((dot(light.direction, from_light) - cos_outer) / span, 0, 1);
    window *= inside * inside;
  }
  return window;
}

RAYSHEAF_HD inline LightSample sample_light(const Light& light, Vec3 position) {
  if (light.type == Light::Type::kDirectional)
    return {-light.direction, std::numeric_limits<float>::infinity(), light.intensity};
  const Vec3 to_light = light.position - position;
  const float distance = length(to_light);
  const Vec3 unit = normalized(to_light);
  if (!(distance > 0)) return {unit, 0, {0, 0, 0}};
  const float falloff = light_window(light, -unit, distance) / distance / distance;
  return {unit, distance, light.intensity * falloff};
}

}  // namespace raysheaf
