// Scenes that raysheaf generates itself, so that the demo and the tests need no files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf {

/// "office", "cornell", "atrium".
[[nodiscard]] std::vector<std::string> builtin_scene_names();

/// A built-in scene by name, the same bits every time. Throws `Error` (kNotFound) for other names.
[[nodiscard]] SceneDescription builtin_scene(std::string_view name);

}  // namespace raysheaf
