#include "parse/frames.h"

#include "parse/parts.h"
#include "render/frames_command.h"
#include "render/stream.h"
#include "values.h"

namespace raysheaf::app {
namespace {

constexpr std::uint32_t kMostTurns = 1'000'000;

[[noreturn]] void refuse(const std::string& option, const std::string& sentence) {
  throw CLI::ValidationError(option, sentence);
}

FrameRange parse_range(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto number = [&](const std::string& part) -> std::optional<std::uint64_t> {
    if (part.empty() && colon != text.npos) return std::nullopt;
    return parse_count(part, 0, 0xffffffff);
  };
  try {
    if (colon == text.npos) return {number(text), number(text)};
    return {number(text.substr(0, colon)), number(text.substr(colon + 1))};
  } catch (const Error&) {
    throw Error(ErrorCode::kInvalidArgument,
                "'" + text + "' is not FIRST:LAST, FIRST:, :LAST, : or a single frame");
  }
}

void check_name(const std::string& option, const std::string& name, bool many) {
  if (name.empty()) return;
  try {
    static_cast<void>(with_frame(name, 0));
  } catch (const Error& error) {
    refuse(option, "'" + name + "': " + error.sentence());
  }
  if (has_frame_field(name) && has_ending(name, ".mp4"))
    refuse(option, "'" + name + "' is one film of all frames, and has no number");
  if (many && !has_frame_field(name) && !has_ending(name, ".mp4")) {
    refuse(option, "'" + name + "' has no place for the frame's number, as frame_%04d.png has");
  }
}

}  // namespace

void add_frames(CLI::App& app, FramesOptions& frames, LoadOptions& load) {
  add_value(app, "--time", "S", "A single picture of a scene that moves, at S seconds [at rest]",
            [&frames](const auto& text) { frames.time = parse_number(text); });
  add_value(app, "--frames", "A:B",
            "Pictures of the frames A to B, either of which may be left out: -o frame_%04d.png or "
            "-o film.mp4 [: where a name has %d]",
            [&frames](const auto& text) { frames.range = parse_range(text); });
  add_value(app, "--fps", "F", "Frames a second; a sequence has its own times [24]",
            [&frames](const auto& text) { frames.fps = parse_positive(text); });
  app.add_option("--clip", frames.clip, "Animation by name or by index from 0 [the first]")
      ->type_name("NAME|INDEX");
  app.add_option("--sequence", frames.sequence,
                 "Files that are the frames, beside SCENE, which stands still; * and ? stand for "
                 "what differs")
      ->type_name("PATTERN");
  add_preload(app, load);
  add_value(app, "--turntable", "N", "N pictures once around the scene",
            [&frames](const auto& text) { frames.turntable = parse_count(text, 1, kMostTurns); });
  app.add_option("--camera-path", frames.camera_path, "Where the camera is and when")
      ->type_name("FILE.json");
  app.add_flag("--resume", frames.resume,
               "Make only the frames whose files are not there yet; go on with a streamed picture "
               "that was stopped");
}

void check_frames(const RenderCommand& command) {
  const FramesOptions& f = command.frames;
  const bool many = wants_frames(command);
  if (!many && f.resume && !is_streamed(command))
    refuse("--resume", "is for the frames of a scene that moves, and for what streams");
  if (!many) return;
  if (f.time) refuse("--time", "is of a single picture, but frames are asked for");
  if (f.turntable != 0 && !f.camera_path.empty())
    refuse("--turntable", "goes around the scene, and --camera-path another way");
  if (!f.camera_path.empty() && !command.options.camera.empty())
    refuse("--camera", "is one of the scene's, and --camera-path has its own");
  if (command.explain) refuse("--explain", "is of a single picture, but frames are asked for");
  const bool single = f.range && f.range->first && f.range->first == f.range->last;
  for (const std::string& path : command.pictures) {
    check_name("-o", path, !single);
    if (f.resume && has_ending(path, ".mp4"))
      refuse("--resume", "cannot go on with a film: write pictures, and make the film of them");
  }
  check_name("--stats", command.stats_path, !single);
  check_name("--heatmap", command.heatmap_path, !single);
}

}  // namespace raysheaf::app
