// A hall's patch cut into tiles, each made separately: memory does not grow with the patch.
#pragma once

#include "raysheaf/stream.h"
#include "scenes/hall_patch.h"

namespace raysheaf::builtin {

/// The triangles of `hall_mesh`, the same bits with the same numbers, as blocks of at most 180 x
/// 180 cells of mesh and instance `id`. Passed to `sink` one after the other, always in the same
/// order; all threads make several at once.
void hall_tiles(const Executor& executor, const HallPatch& patch, PatchGrid grid, std::uint32_t id,
                BlockSink* sink);

}  // namespace raysheaf::builtin
