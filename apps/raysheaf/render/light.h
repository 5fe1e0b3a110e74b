// Applies the light options of the command line to a scene.
#pragma once

#include "options.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::app {

/// Gives the scene the environment of `--env`. Throws as `load_environment` does.
void set_environment(const LightOptions& options, UpAxis up, SceneDescription& scene);
/// Gives point and spot lights the size of `--light-size`.
void set_light_size(const LightOptions& options, SceneDescription& scene);

/// Diameter of the lens; 0: a pinhole. Cameras of a path are pinholes.
[[nodiscard]] float aperture_of(const RenderCommand& command, const SceneDescription& scene);

/// Where the command line leaves them open: a neutral background for a scene without an
/// environment, and the number of samples.
void set_look(RenderCommand* command, const SceneDescription& scene);

}  // namespace raysheaf::app
