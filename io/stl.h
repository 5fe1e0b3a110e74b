// STL: ASCII and binary.
#pragma once

#include <memory>
#include <string>

#include "io/file.h"
#include "io/outer_cut.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// Every triangle has its own vertices and no vertex normals: it stays flat.
[[nodiscard]] SceneDescription load_stl(const Bytes& file, const SceneFile& from);

/// The triangles of a binary file, and the rest of its scene, in memory that does not grow with it.
struct OuterStl {
  SceneDescription scene;
  std::unique_ptr<OuterTriangles> triangles;  ///< null: see `pack_file`
};
[[nodiscard]] OuterStl read_outer_stl(const std::string& path, const PackOptions& options);

}  // namespace raysheaf::io
