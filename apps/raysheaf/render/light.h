// What the command line says of a scene's light.
#pragma once

#include "options.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::app {

/// Gives the scene the environment of `--env`. Throws what `load_environment` throws.
void set_environment(const LightOptions& options, SceneDescription& scene);
/// Gives points and spots the size of `--light-size`.
void set_light_size(const LightOptions& options, SceneDescription& scene);

}  // namespace raysheaf::app
