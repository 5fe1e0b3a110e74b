#include "render/light.h"

#include <numbers>

#include "raysheaf/io.h"

namespace raysheaf::app {

void set_environment(const LightOptions& options, SceneDescription& scene) {
  if (!options.environment.empty()) scene.environment = load_environment(options.environment);
  if (options.intensity) scene.environment.intensity = *options.intensity;
  if (options.rotation_degrees)
    scene.environment.rotation = *options.rotation_degrees * std::numbers::pi_v<float> / 180;
}

void set_light_size(const LightOptions& options, SceneDescription& scene) {
  for (Light& light : scene.lights) {
    const bool point = light.type == Light::Type::kPoint || light.type == Light::Type::kSpot;
    if (options.size && point) light.radius = *options.size;
  }
}

}  // namespace raysheaf::app
