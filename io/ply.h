// Stanford PLY: ASCII, binary of either byte order.
#pragma once

#include <optional>
#include <string>

#include "io/file.h"
#include "io/outer_mesh.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

[[nodiscard]] SceneDescription load_ply(const Bytes& file, const SceneFile& from);

/// The same of a binary file, in memory that does not grow with it. Nothing of ASCII, and of a file
/// so small that it may be held. Throws what `load_ply` throws, and `NeedsWholeFile` where a list
/// has more corners than should be held.
[[nodiscard]] std::optional<OuterScene> read_outer_ply(const std::string& path,
                                                       const PackOptions& options);

}  // namespace raysheaf::io
