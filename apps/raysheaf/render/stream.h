// Scenes that stream: block files, and others cut into blocks in memory.
#pragma once

#include <memory>
#include <string>

#include "options.h"
#include "raysheaf/checkpoint.h"
#include "raysheaf/distributed.h"
#include "raysheaf/stream.h"

namespace raysheaf::app {

[[nodiscard]] bool is_block_file(const std::string& path);
/// Whether the frame is rendered block by block.
[[nodiscard]] bool is_streamed(const RenderCommand& command);

/// SCENE where it is a block file, or a file that would take more than `--memory` and can be
/// packed: into a file that is gone with the program. Else null.
[[nodiscard]] std::unique_ptr<GeometrySource> open_blocks(const RenderCommand& command);

/// Where a streamed frame keeps what it has found, beside its first output: `hall.png.resume`, or
/// `hall.png.1-of-4.resume` of rank 1. Throws `Error` (kInvalidArgument) where there is no output.
[[nodiscard]] std::string checkpoint_path(const RenderCommand& command, const Communicator* ranks);
/// Null where the command does not ask for it. `files`: what the scene is made of.
[[nodiscard]] std::unique_ptr<CheckpointFile> open_checkpoint(
    const RenderCommand& command, const Communicator* ranks, const std::vector<std::string>& files);

/// Puts what was read and what was not into the JSON of a frame's statistics.
[[nodiscard]] std::string with_stream(std::string json, const StreamStatistics& statistics);
/// The same in a line for people.
[[nodiscard]] std::string stream_text(const StreamStatistics& statistics);

}  // namespace raysheaf::app
