// Stanford PLY: ASCII, binary of either byte order.
#pragma once

#include <string>

#include "io/file.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

[[nodiscard]] SceneDescription load_ply(const Bytes& file, const SceneFile& from);

}  // namespace raysheaf::io
