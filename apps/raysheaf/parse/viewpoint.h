// From where a picture is seen, on the command line.
#pragma once

#include <CLI/CLI.hpp>

#include "options.h"

namespace raysheaf::app {

void add_viewpoint(CLI::App& app, ViewOptions& view);
/// Refuses what contradicts itself, or --camera and --camera-path. `app` was parsed.
void check_viewpoint(const CLI::App& app, RenderCommand& command);

}  // namespace raysheaf::app
