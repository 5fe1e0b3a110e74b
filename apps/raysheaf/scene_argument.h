// SCENE on the command line: a file, or "builtin:NAME".
#pragma once

#include <string>

#include "raysheaf/io.h"

namespace raysheaf::app {

/// The scene as it stands, without a camera or a light added. Throws `Error`: kInvalidArgument for
/// a built-in name that is none, else what `load_scene` throws.
[[nodiscard]] SceneDescription scene_from_argument(const std::string& argument,
                                                   const LoadOptions& options = {});

/// The built-in scene NAME; `place` is what an error names.
[[nodiscard]] SceneDescription builtin_from_name(const std::string& name, const std::string& place);

}  // namespace raysheaf::app
