// `render` over the frames of a scene that moves.
#pragma once

#include "options.h"
#include "render/frames.h"

namespace raysheaf::app {

/// Whether the command makes a picture a frame, and not a single one.
[[nodiscard]] bool wants_frames(const RenderCommand& command);

/// Makes the frames that the command asks for. Whatever is written is whole: a run that ends early
/// leaves the frames before, and `--resume` makes the others.
void render_frames(const RenderCommand& command, Animation& animation);

}  // namespace raysheaf::app
