// Options for the files that `render` writes.
#pragma once

#include <CLI/CLI.hpp>

#include "options.h"

namespace raysheaf::app {

/// -o.
void add_outputs(CLI::App& app, RenderCommand& command);
/// All other files, the background, and what the terminal shows.
void add_other_outputs(CLI::App& app, RenderCommand& command);
void check_outputs(const RenderCommand& command);

}  // namespace raysheaf::app
