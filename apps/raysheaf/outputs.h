// Files that a command will write: known to be writable before the work starts.
#pragma once

#include <string>

#include "raysheaf/render.h"

namespace raysheaf::app {

/// Where writing to `path` ends: symbolic links followed, so that replacing the file keeps the
/// link. Throws `Error` (kIo, place `path`) where a file could not be made or replaced there, or
/// where something other than a plain file stands. Nothing is left behind.
[[nodiscard]] std::string writable_path(const std::string& path);

/// Throws `Error` (kInvalidArgument, place `output`) where both name one file.
void refuse_scene_as_output(const std::string& scene, const std::string& output);

/// PNG (tone-mapped) or OpenEXR (linear, with layers), by the ending of `name`.
void write_picture(const RenderResult& result, const std::string& name, const std::string& path);

}  // namespace raysheaf::app
