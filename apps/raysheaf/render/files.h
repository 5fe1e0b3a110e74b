// The files that `render` reads, so that it does not overwrite them.
#pragma once

#include "apps/support/output_files.h"
#include "options.h"

namespace raysheaf::app {

/// Contains the files of the command line; the other files of the scene are known once it is
/// loaded.
[[nodiscard]] OutputFiles output_files(const RenderCommand& command);

}  // namespace raysheaf::app
