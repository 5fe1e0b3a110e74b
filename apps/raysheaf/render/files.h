// What `render` reads, so that it writes over none of it.
#pragma once

#include "options.h"
#include "outputs.h"

namespace raysheaf::app {

/// Knows what the command line names; the scene's other files are known once it is loaded.
[[nodiscard]] OutputFiles output_files(const RenderCommand& command);

}  // namespace raysheaf::app
