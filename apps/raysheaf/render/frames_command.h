// `render` over the frames of a scene that moves.
#pragma once

#include <memory>

#include "options.h"
#include "raysheaf/distributed.h"
#include "raysheaf/stream.h"
#include "render/frames.h"

namespace raysheaf::app {

/// Whether the command makes a picture a frame, and not a single one.
[[nodiscard]] bool wants_frames(const RenderCommand& command);

/// Makes the frames that the command asks for. Whatever is written is whole: a run that ends early
/// leaves the frames before, and `--resume` makes the others. Processes make and write a frame each
/// where there are enough frames; for films, and where the command says so, they share the rays of
/// each, and rank 0 writes. `blocks`: those of a file that `animation` describes, or null. `ranks`:
/// null for one process.
void render_frames(const RenderCommand& command, const GeometrySource* blocks, Animation& animation,
                   const std::shared_ptr<Communicator>& ranks);

}  // namespace raysheaf::app
