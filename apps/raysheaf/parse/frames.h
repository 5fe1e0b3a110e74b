// The options of `render` for moving scenes.
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

void add_frames(CLI::App& app, FramesOptions& frames, LoadOptions& load);

/// Throws `CLI::ValidationError` if options or names of outputs contradict each other.
void check_frames(const RenderCommand& command);

}  // namespace raysheaf::app
