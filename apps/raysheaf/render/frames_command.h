// `render` for the frames of a moving scene.
#pragma once

#include <memory>

#include "options.h"
#include "raysheaf/distributed.h"
#include "raysheaf/stream.h"
#include "render/frames.h"

namespace raysheaf::app {

/// Whether the command requests frames instead of a single image.
[[nodiscard]] bool wants_frames(const RenderCommand& command);

/// Makes the frames that the command requests. Every file is complete: a run that ends early leaves
/// the frames before, and `--resume` makes the others. If there are enough frames, each process
/// makes and writes whole frames; for films, and if the command requests it, the processes share
/// the rays of each frame, and rank 0 writes. `blocks`: those of a file that `animation` describes,
/// or null. `ranks`: null for one process.
void render_frames(const RenderCommand& command, const GeometrySource* blocks, Animation& animation,
                   const std::shared_ptr<Communicator>& ranks);

}  // namespace raysheaf::app
