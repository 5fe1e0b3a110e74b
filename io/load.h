// Loads scene files that are part of a larger scene.
#pragma once

#include "io/file.h"
#include "raysheaf/io.h"

namespace raysheaf::io {

/// Like `load_scene`, but the file may have no triangles. Images of OBJ materials are taken from
/// `images`, and added to it.
[[nodiscard]] SceneDescription load_part(const std::string& path, const LoadOptions& options,
                                         ImageCache* images);

}  // namespace raysheaf::io
