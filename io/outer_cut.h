// Cuts triangles into the same blocks as `cut_into_blocks`, with the triangles in files if there
// are too many for the memory:
//
//   all triangles ─► a whole number of blocks on one side of a plane │ the rest on the other side
//   ─► both sides recursively, until one fits into memory ─► cut_into_blocks
//
// A plane is a rank along the longest side of the box of the triangles' centres, so that the cut
// depends only on the order of (coordinate, number). The rank is found by counting leading bits of
// these sort keys.
#pragma once

#include <optional>

#include "io/outer_mesh.h"

namespace raysheaf::io {

/// Like `cut_into_blocks`. `scene.rest` is valid except that it has no triangles. Returns nothing,
/// and adds nothing to `sink`, if a triangle is too far out, or if there are none or at least 2^32
/// of them.
[[nodiscard]] std::optional<SceneDescription> cut_outer(OuterScene scene, BlockSink* sink,
                                                        const PackOptions& options);

}  // namespace raysheaf::io
