// Where a picture goes that was given no name.
#pragma once

#include <string>

#include "options.h"

namespace raysheaf::app {

/// Whether the command names nothing that it would write or print.
[[nodiscard]] bool writes_nothing(const RenderCommand& command);

/// "duck.png" of "models/duck.glb" and "cornell.png" of "builtin:cornell", in the current folder;
/// "duck-2.png" and so on where there is such a file already: none is replaced that was not named.
[[nodiscard]] std::string default_picture(const std::string& scene);

}  // namespace raysheaf::app
