// Loads STL: ASCII and binary.
#pragma once

#include <optional>
#include <string>

#include "io/file.h"
#include "io/outer_mesh.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// Triangles are flat: each has its own vertices, without normals.
[[nodiscard]] SceneDescription load_stl(const Bytes& file, const SceneFile& from);

/// Whether the file begins as ASCII files do, has the length that its count as a binary file
/// demands, or begins with zeros, as the headers of many binary files do.
[[nodiscard]] bool may_be_stl(const Bytes& file);

/// Reads a binary file in memory that does not grow with it. Returns nothing for ASCII files, and
/// for files with at most `triangles_at_once` triangles.
[[nodiscard]] std::optional<OuterScene> read_outer_stl(const std::string& path,
                                                       const PackOptions& options);

}  // namespace raysheaf::io
