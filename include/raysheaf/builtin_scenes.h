// Scenes that raysheaf generates itself, so that the demo and the tests need no files.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf {

/// "office", "cornell", "atrium".
[[nodiscard]] std::vector<std::string> builtin_scene_names();

/// A built-in scene by name, the same bits every time. Throws `Error` (kNotFound) for other names.
[[nodiscard]] SceneDescription builtin_scene(std::string_view name);

/// A closed hall with rough walls, columns and balls, a camera and a lamp inside: the finest cut of
/// at most `triangles`, of which 4 000 to 200 000 000 may be asked for (`Error`, kInvalidArgument,
/// for others). 52 bytes of memory a triangle at most. `threads` = 0 takes all cores; the scene
/// does not depend on it.
[[nodiscard]] SceneDescription hall_scene(std::uint64_t triangles, std::uint32_t threads = 0);

}  // namespace raysheaf
