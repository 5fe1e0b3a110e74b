// The options of `raysheaf render` for light, lens and samples.
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

void add_light(CLI::App& app, RenderCommand& command);

}  // namespace raysheaf::app
