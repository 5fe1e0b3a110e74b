// Triangles cut into blocks as `cut_into_blocks` cuts them, where there are more than memory should
// hold: they lie in files.
//
//   all ─► as many as they are blocks' worth on the left of a plane │ the others ─► again, until
//   what is left may be held ─► cut_into_blocks
//
// A plane is a rank along the longest side of the box of centres, so that where triangles go
// depends on their order by (coordinate, number) alone. It is found by counting leading bits of
// that order.
#pragma once

#include <optional>

#include "io/outer_mesh.h"

namespace raysheaf::io {

/// As `cut_into_blocks`. `scene.rest` is valid but for its triangles. Nothing, before anything was
/// added to `sink`, where one is too far out, or where there are none, or 2^32 and more.
[[nodiscard]] std::optional<SceneDescription> cut_outer(OuterScene scene, BlockSink* sink,
                                                        const PackOptions& options);

}  // namespace raysheaf::io
