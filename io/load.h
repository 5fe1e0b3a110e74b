// Scene files of any kind, for what is made of several.
#pragma once

#include "io/image_cache.h"
#include "raysheaf/io.h"

namespace raysheaf::io {

/// As `load_scene`, for a part of a scene: it may have no triangles. Pictures that OBJ's materials
/// show are taken from `images` where they are there, and kept there.
[[nodiscard]] SceneDescription load_part(const std::string& path, const LoadOptions& options,
                                         ImageCache* images);

}  // namespace raysheaf::io
