// Cuts files into blocks without holding them in memory.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "raysheaf/stream.h"
#include "raysheaf/viewpoint.h"

namespace raysheaf {

struct PackOptions {
  std::uint32_t triangles_a_block = kBlockTriangles;  ///< 1 to `kBlockTriangles`
  /// Triangles held in memory at once, about 250 bytes each, but at least `triangles_a_block`. The
  /// blocks do not depend on it.
  std::uint32_t triangles_at_once = 1u << 19;
  /// Temporary files are created without a name in the folder of this file; docs/stream.md states
  /// their size.
  std::string beside;
  bool allow_external = false;  ///< as `LoadOptions::allow_external`
  bool add_light = true;        ///< if the scene has none
  /// The added camera: if the scene has none or, with `add_camera`, after its own cameras.
  Viewpoint viewpoint = {};
  bool add_camera = false;
};

/// Produces the same blocks and the same scene as `cut_into_blocks` of the result of `load_scene`,
/// in memory that does not grow with the meshes. Supports binary STL with more than
/// `triangles_at_once` triangles, and binary PLY and glTF (with its buffers) of more than 16 bytes
/// for each of those. Images, materials, nodes and JSON are held in memory. Returns nothing for all
/// other files and for files that must be read as a whole (docs/stream.md); in this case nothing
/// was added to `sink`. Throws `Error`: as `load_scene` does, kIo for temporary files, and the
/// sink's errors.
[[nodiscard]] std::optional<SceneDescription> pack_file(const std::string& path, BlockSink* sink,
                                                        const PackOptions& options);

}  // namespace raysheaf
