// The options of `render` for scenes that move.
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

void add_frames(CLI::App& app, FramesOptions& frames, LoadOptions& load);

/// Throws `CLI::ValidationError` where options or names of outputs do not go together.
void check_frames(const RenderCommand& command);

}  // namespace raysheaf::app
