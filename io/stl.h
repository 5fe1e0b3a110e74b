// STL: ASCII and binary.
#pragma once

#include <string>

#include "io/file.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// Every triangle has its own vertices and no vertex normals: it stays flat.
[[nodiscard]] SceneDescription load_stl(const Bytes& file, const SceneFile& from);

}  // namespace raysheaf::io
