// What `render` writes, and before which background.
#pragma once

#include <CLI/CLI.hpp>

#include "options.h"

namespace raysheaf::app {

void add_outputs(CLI::App& app, RenderCommand& command);
void add_background(CLI::App& app, RenderCommand& command);
void check_outputs(const RenderCommand& command);

}  // namespace raysheaf::app
