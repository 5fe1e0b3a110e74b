// STL: ASCII and binary.
#pragma once

#include <optional>
#include <string>

#include "io/file.h"
#include "io/outer_mesh.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// Every triangle has its own vertices and no vertex normals: it stays flat.
[[nodiscard]] SceneDescription load_stl(const Bytes& file, const SceneFile& from);

/// Whether it begins as ASCII does, is as long as a binary file's count demands, or begins with
/// zeros, as the heads of binary files may.
[[nodiscard]] bool may_be_stl(const Bytes& file);

/// The same of a binary file, in memory that does not grow with it. Nothing of others, and of those
/// with `triangles_at_once` or less.
[[nodiscard]] std::optional<OuterScene> read_outer_stl(const std::string& path,
                                                       const PackOptions& options);

}  // namespace raysheaf::io
