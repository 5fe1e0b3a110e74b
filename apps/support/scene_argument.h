// SCENE on the command line: a file, or "builtin:NAME".
#pragma once

#include <string>

#include "raysheaf/io.h"

namespace raysheaf::app {

/// The scene as it is, without an added camera or light. Throws `Error`: kInvalidArgument for an
/// unknown built-in name, otherwise as `load_scene` does.
[[nodiscard]] SceneDescription scene_from_argument(const std::string& argument,
                                                   const LoadOptions& options = {});

/// The built-in scene NAME; errors name `place`.
[[nodiscard]] SceneDescription builtin_from_name(const std::string& name, const std::string& place);

}  // namespace raysheaf::app
