#include "render/light.h"

#include <numbers>

#include "raysheaf/backdrop.h"
#include "raysheaf/cameras.h"
#include "raysheaf/error.h"
#include "raysheaf/io.h"
#include "raysheaf/studio.h"

namespace raysheaf::app {

void set_environment(const LightOptions& options, UpAxis up, SceneDescription& scene) {
  if (!options.environment.empty()) {
    scene.environment = load_environment(options.environment);
    const std::vector<std::string>& warnings = scene.environment.warnings;
    scene.warnings.insert(scene.warnings.end(), warnings.begin(), warnings.end());
  }
  if (options.intensity) scene.environment.intensity = *options.intensity;
  if (options.rotation_degrees)
    scene.environment.rotation = *options.rotation_degrees * std::numbers::pi_v<float> / 180;
  if (!options.sun) return;
  const auto* position = std::get_if<SunPosition>(&*options.sun);
  try {
    add_sun_and_sky(
        scene, position != nullptr ? sun_direction(*position, up) : std::get<Vec3>(*options.sun),
        up);
  } catch (const Error& error) {
    throw Error(error.code(), error.sentence(), "--sun");
  }
}

void set_light_size(const LightOptions& options, SceneDescription& scene) {
  for (Light& light : scene.lights) {
    const bool point = light.type == Light::Type::kPoint || light.type == Light::Type::kSpot;
    if (options.size && point) light.radius = *options.size;
  }
}

float aperture_of(const RenderCommand& command, const SceneDescription& scene) {
  const RenderOptions& options = command.options;
  if (options.aperture) return *options.aperture;
  const bool on_path = !command.frames.camera_path.empty();
  return on_path ? 0 : find_camera(scene, options.camera).aperture;
}

void set_look(RenderCommand* command, const SceneDescription& scene) {
  if (!scene.environment.empty()) return;
  if (!command->background) command->background = kNeutralBackground;
  RenderOptions& options = command->options;
  const bool is_builtin = command->scene.starts_with("builtin:");
  if (options.samples == 0 && !is_builtin && aperture_of(*command, scene) == 0)
    options.samples = kPictureSamples;
}

}  // namespace raysheaf::app
