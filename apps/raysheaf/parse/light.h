// The options of `raysheaf render` for light, lens and samples. CLI11 is seen by the parse files
// alone.
#pragma once

#include <CLI/CLI.hpp>

#include "options.h"

namespace raysheaf::app {

void add_light(CLI::App& app, RenderCommand& command);

}  // namespace raysheaf::app
