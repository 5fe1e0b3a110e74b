// Scenes that stream: block files, and others cut into blocks in memory.
#pragma once

#include <memory>
#include <string>

#include "options.h"
#include "raysheaf/stream.h"

namespace raysheaf::app {

[[nodiscard]] bool is_block_file(const std::string& path);
/// Whether the frame is rendered block by block.
[[nodiscard]] bool is_streamed(const RenderCommand& command);

/// Where the blocks of a streamed frame come from.
[[nodiscard]] std::unique_ptr<GeometrySource> open_blocks(const RenderCommand& command);

/// Puts what was read and what was not into the JSON of a frame's statistics.
[[nodiscard]] std::string with_stream(std::string json, const StreamStatistics& statistics);
/// The same in a line for people.
[[nodiscard]] std::string stream_text(const StreamStatistics& statistics);

}  // namespace raysheaf::app
