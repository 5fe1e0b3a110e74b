// The files that `render` writes, and the background of their pictures.
#pragma once

#include <CLI/CLI.hpp>

#include "options.h"

namespace raysheaf::app {

void add_outputs(CLI::App& app, RenderCommand& command);
void add_background(CLI::App& app, RenderCommand& command);
void check_outputs(const RenderCommand& command);

}  // namespace raysheaf::app
