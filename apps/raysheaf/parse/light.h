// The options of `raysheaf render` for samples, the lens and light.
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

void add_samples(CLI::App& app, RenderCommand& command);
/// Aperture and focus.
void add_lens(CLI::App& app, RenderCommand& command);
/// Sizes of lights, and the environment.
void add_light(CLI::App& app, RenderCommand& command);

}  // namespace raysheaf::app
