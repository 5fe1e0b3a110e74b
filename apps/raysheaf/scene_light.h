// What the command line says of a scene's light.
#pragma once

#include "options.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::app {

/// Gives the scene the environment of `--env`, what it lacks of camera and light, and points and
/// spots the size of `--light-size`. Throws what `load_environment` throws.
void change_light(const LightOptions& options, SceneDescription& scene);

}  // namespace raysheaf::app
