// Options for the viewpoint of an image.
#pragma once

#include <CLI/CLI.hpp>

#include "options.h"

namespace raysheaf::app {

/// --view and --up.
void add_common_viewpoint(CLI::App& app, ViewOptions& view);
/// All other options of the viewpoint.
void add_viewpoint(CLI::App& app, ViewOptions& view);
/// Refuses viewpoints that contradict themselves, --camera or --camera-path. `app` was parsed.
void check_viewpoint(const CLI::App& app, RenderCommand& command);

}  // namespace raysheaf::app
