// The name of an image whose name was not given.
#pragma once

#include <string>

#include "options.h"

namespace raysheaf::app {

/// Whether the command requests no output at all. Statistics of a single image accompany it.
[[nodiscard]] bool writes_nothing(const RenderCommand& command);

/// "duck.png" for "models/duck.glb" and "cornell.png" for "builtin:cornell", in the current folder;
/// "duck-2.png" and so on if such a file exists: only files that the user named are replaced.
[[nodiscard]] std::string default_picture(const std::string& scene);

}  // namespace raysheaf::app
