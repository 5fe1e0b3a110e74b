#include "render/stream.h"
#include "render/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "apps/support/console.h"
#include "apps/support/output_files.h"
#include "apps/support/stoppable_sink.h"
#include "apps/support/table.h"
#include "apps/support/values.h"
#include "raysheaf/block_file.h"
#include "raysheaf/error.h"
#include "render/frames_command.h"
#include "render/viewpoint.h"
#include "system/process.h"

namespace raysheaf::app {

bool is_block_file(const std::string& path) {
  return has_ending(path, ".rsb");
}

bool is_streamed(const RenderCommand& command) {
  return command.stream || is_block_file(command.scene);
}

namespace {

/// Bytes in memory that a scene and its blocks take for each byte of its file.
constexpr std::uint64_t kBytesHeldPerByte = 6;

/// Whether the animation of the file is not used.
bool stands_still(const RenderCommand& command) {
  return !wants_frames(command) && !command.frames.time && command.frames.clip.empty() &&
         command.frames.sequence.empty();
}

std::unique_ptr<GeometrySource> packed_beside(const RenderCommand& command) {
  std::string name = (std::filesystem::temp_directory_path() / "raysheaf").string();
  for (const std::string& path : {command.heatmap_path, command.stats_path})
    if (!path.empty()) name = path;
  for (const std::string& path : command.pictures) {
    if (path == kStandardOutput) continue;
    name = path;
    break;
  }
  name += fmt::format(".{}.rsb", system::process_number());
  constexpr std::uint64_t kBytesATriangle = 250;  // raysheaf/block_file.h
  PackOptions options;
  options.triangles_at_once = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(
      command.memory_bytes / 4 / kBytesATriangle, 1, options.triangles_at_once));
  options.beside = name;
  options.allow_external = command.load.allow_external;
  options.add_light = command.light.environment.empty();
  options.viewpoint = viewpoint_of(command);
  options.add_camera = command.view.is_own;
  if (!options.add_camera) options.viewpoint.zoom = 1;  // as for cameras of the file
  BlockFileWriter file(name);
  StoppableSink sink(&file);
  const auto scene = pack_file(command.scene, &sink, options);
  if (!scene) return nullptr;
  if (!command.quiet) {
    tell_warnings(scene->warnings);
  }
  file.finish(*scene);
  auto blocks = std::make_unique<BlockFile>(name);
  std::filesystem::remove(name);  // the open file remains readable
  return blocks;
}

}  // namespace

std::unique_ptr<GeometrySource> open_blocks(const RenderCommand& command) {
  if (is_block_file(command.scene)) return std::make_unique<BlockFile>(command.scene);
  std::error_code none;
  const std::uint64_t size = std::filesystem::file_size(command.scene, none);
  const bool is_large = !none && size > command.memory_bytes / kBytesHeldPerByte;
  return command.stream && is_large && stands_still(command) ? packed_beside(command) : nullptr;
}

std::string checkpoint_path(const RenderCommand& command, const Communicator* ranks) {
  std::vector<std::string> outputs = command.pictures;
  std::erase(outputs, kStandardOutput);
  for (const std::string& path : {command.heatmap_path, command.stats_path})
    if (!path.empty()) outputs.push_back(path);
  if (outputs.empty())
    throw Error(ErrorCode::kInvalidArgument, "keeps its data next to an output: give -o",
                "--resume");
  std::string path = outputs.front();
  if (ranks != nullptr) path += fmt::format(".{}-of-{}", ranks->rank(), ranks->size());
  return path + ".resume";
}

std::unique_ptr<CheckpointFile> open_checkpoint(const RenderCommand& command,
                                                const Communicator* ranks,
                                                const std::vector<std::string>& files) {
  if (!command.frames.resume) return nullptr;
  const std::string path = checkpoint_path(command, ranks);
  // A scene is a different one if one of its files was written again, and a moving one also at
  // another time.
  const FramesOptions& frames = command.frames;
  std::string subject = frames.time ? fmt::format("{} at {} ", frames.clip, *frames.time) : "";
  for (const std::string& file : files) {
    std::error_code none;
    const auto size = std::filesystem::file_size(file, none);
    const auto written = std::filesystem::last_write_time(file, none).time_since_epoch();
    subject += fmt::format("{} {} {} ", file, size, written.count());
  }
  return std::make_unique<CheckpointFile>(path, subject);
}

std::string with_stream(std::string json, const StreamStatistics& s) {
  const std::string stream = fmt::format(
      ",\n  \"stream\": {{\n"
      "    \"blocks\": {},\n    \"culled_blocks\": {},\n    \"hidden_blocks\": {},\n"
      "    \"read_blocks\": {},\n    \"wasted_blocks\": {},\n    \"shading_blocks\": {},\n"
      "    \"read_bytes\": {},\n    \"times_ms\": {{\"read\": {}, \"wait\": {}, \"cull\": {}, "
      "\"trace\": {}, \"shading\": {}}}\n  }}",
      s.blocks, s.culled_blocks, s.hidden_blocks, s.read_blocks, s.wasted_blocks, s.shading_blocks,
      s.read_bytes, s.read_ms, s.wait_ms, s.cull_ms, s.trace_ms, s.shading_ms);
  return json.insert(json.rfind("\n}"), stream);
}

std::string stream_text(const StreamStatistics& s) {
  return fmt::format(
      "streamed {}: {} culled by bounds, {} hidden behind hits, {} read ({} in vain), {} read for "
      "shading; {:.1f} MB, waited {:.0f} ms",
      count_text(s.blocks, "block", "blocks"), s.culled_blocks, s.hidden_blocks, s.read_blocks,
      s.wasted_blocks, s.shading_blocks, static_cast<double>(s.read_bytes) * 1e-6, s.wait_ms);
}

}  // namespace raysheaf::app
