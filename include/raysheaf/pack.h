// Files cut into blocks without being held in memory.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "raysheaf/stream.h"
#include "raysheaf/viewpoint.h"

namespace raysheaf {

struct PackOptions {
  std::uint32_t triangles_a_block = kBlockTriangles;  ///< 1 to `kBlockTriangles`
  /// That are held at once, about 250 bytes each; `triangles_a_block` are in any case. The blocks
  /// do not depend on it.
  std::uint32_t triangles_at_once = 1u << 19;
  /// Temporary files are made in the folder of this name, and have none of their own;
  /// docs/stream.md has how long they become.
  std::string beside;
  bool allow_external = false;  ///< as that of `LoadOptions`
  bool add_light = true;        ///< where the scene has none
  /// The camera that is added: where the scene has none, or, with `add_camera`, behind its own.
  Viewpoint viewpoint = {};
  bool add_camera = false;
};

/// What `cut_into_blocks` gives of the scene that `load_scene` reads, the same blocks and the same
/// scene, in memory that does not grow with its meshes: of binary STL with more than
/// `triangles_at_once` triangles, and of binary PLY and of glTF with its buffers that have more
/// than 16 bytes for each of those. Pictures, materials, nodes and JSON are held. Of all other
/// files nothing, and nothing where they have to be read whole (docs/stream.md): before anything
/// was added to `sink` it is known. Throws `Error`: what `load_scene` throws of such a file, kIo of
/// temporary files, and what the sink throws.
[[nodiscard]] std::optional<SceneDescription> pack_file(const std::string& path, BlockSink* sink,
                                                        const PackOptions& options);

}  // namespace raysheaf
