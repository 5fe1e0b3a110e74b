// Scenes that stream: block files, and other scenes cut into blocks in memory.
#pragma once

#include <memory>
#include <string>

#include "options.h"
#include "raysheaf/block_file.h"
#include "raysheaf/distributed.h"
#include "raysheaf/stream.h"

namespace raysheaf::app {

[[nodiscard]] bool is_block_file(const std::string& path);
/// Whether the frame is rendered block by block.
[[nodiscard]] bool is_streamed(const RenderCommand& command);

/// SCENE if it is a block file, or if its file would take more than `--memory` and can be packed,
/// into a file that is removed with the program. Otherwise null.
[[nodiscard]] std::unique_ptr<GeometrySource> open_blocks(const RenderCommand& command);

/// The file next to the first output in which a streamed frame keeps its intermediate results:
/// `hall.png.resume`, or `hall.png.1-of-4.resume` for rank 1. Throws `Error` (kInvalidArgument)
/// without an output.
[[nodiscard]] std::string checkpoint_path(const RenderCommand& command, const Communicator* ranks);
/// Null if the command does not request it. `files` are those of the scene.
[[nodiscard]] std::unique_ptr<CheckpointFile> open_checkpoint(
    const RenderCommand& command, const Communicator* ranks, const std::vector<std::string>& files);

/// Adds the counts of read and skipped blocks to the JSON of a frame's statistics.
[[nodiscard]] std::string with_stream(std::string json, const StreamStatistics& statistics);
/// The same as a line of text.
[[nodiscard]] std::string stream_text(const StreamStatistics& statistics);

}  // namespace raysheaf::app
