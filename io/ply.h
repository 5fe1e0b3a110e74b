// Loads Stanford PLY: ASCII, and binary of either byte order.
#pragma once

#include <optional>
#include <string>

#include "io/file.h"
#include "io/outer_mesh.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

[[nodiscard]] SceneDescription load_ply(const Bytes& file, const SceneFile& from);

/// Reads a binary file in memory that does not grow with it. Returns nothing for ASCII and for a
/// file small enough to be read whole. Throws what `load_ply` throws, and `NeedsWholeFile` if a
/// list has too many corners for the memory limit.
[[nodiscard]] std::optional<OuterScene> read_outer_ply(const std::string& path,
                                                       const PackOptions& options);

}  // namespace raysheaf::io
