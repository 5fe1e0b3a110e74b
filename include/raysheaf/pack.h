// Files cut into blocks without being held in memory.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "raysheaf/stream.h"

namespace raysheaf {

struct PackOptions {
  std::uint32_t triangles_a_block = kBlockTriangles;  ///< 1 to `kBlockTriangles`
  /// That are held at once, about 170 bytes each; `triangles_a_block` are in any case. The blocks
  /// do not depend on it.
  std::uint32_t triangles_at_once = 1u << 19;
  /// Temporary files are made in the folder of this name, and have none of their own: 52 bytes a
  /// triangle, twice.
  std::string beside;
};

/// What `cut_into_blocks` gives of the scene that `load_scene` reads, the same blocks and the same
/// scene, in memory that does not grow with the file: of binary STL with more than
/// `triangles_at_once` triangles. Of all other files, and of those that `load_scene` or
/// `cut_into_blocks` would refuse: nothing, before anything was added to `sink`. Throws `Error`:
/// kIo, and what the sink throws.
[[nodiscard]] std::optional<SceneDescription> pack_file(const std::string& path, BlockSink* sink,
                                                        const PackOptions& options);

}  // namespace raysheaf
