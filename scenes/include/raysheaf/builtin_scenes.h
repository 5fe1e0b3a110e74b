// Scenes that raysheaf generates itself, so that the demo and the tests need no files.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf {

class BlockSink;  // raysheaf/stream.h

/// "office", "cornell", "atrium".
[[nodiscard]] std::vector<std::string> builtin_scene_names();

/// A built-in scene by name, the same bits every time. Throws `Error` (kNotFound) for other names.
[[nodiscard]] SceneDescription builtin_scene(std::string_view name);

/// A closed hall with rough walls, columns and spheres, and with a camera and a lamp inside. It has
/// the finest tessellation of at most `triangles`, which must lie between 4 000 and 200 000 000
/// (otherwise `Error`, kInvalidArgument). Takes at most 52 bytes of memory per triangle. The scene
/// does not depend on `threads`; 0 uses all cores.
[[nodiscard]] SceneDescription hall_scene(std::uint64_t triangles, std::uint32_t threads = 0);

/// `hall_scene`, block by block (raysheaf/stream.h), as it is generated: memory does not
/// grow with it, and there may be 2 000 000 000 triangles. Returns the scene without triangles.
[[nodiscard]] SceneDescription hall_in_blocks(std::uint64_t triangles, BlockSink* sink,
                                              std::uint32_t threads = 0);

}  // namespace raysheaf
