#include "parse/commands.h"

#include "apps/support/values.h"
#include "parse/parts.h"
#include "render/film.h"
#include "render/frames_command.h"
#include "render/stream.h"

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
  if (has_frame_field(name) && is_film_name(name))
    refuse(option, "'" + name + "' is one film of all frames and takes no number");
  if (many && !has_frame_field(name) && !is_film_name(name)) {
    refuse(option, "'" + name + "' has no place for the frame's number, as frame_%04d.png has");
  }
}

}  // namespace

void add_frames(CLI::App& app, FramesOptions& frames, LoadOptions& load) {
  begin_group(app, kAnimationGroup);
  add_value(app, "--time", "S", "Render a single image, at S seconds [the scene at rest]",
            [&frames](const auto& text) { frames.time = parse_number(text); });
  add_value(app, "--frames", "A:B",
            "Render the frames A to B, either of which may be omitted, to -o frame_%04d.png or -o "
            "film.mp4 [all frames, if a name has %d]",
            [&frames](const auto& text) { frames.range = parse_range(text); });
  add_value(app, "--fps", "F", "Frames per second; a sequence may have its own times [24]",
            [&frames](const auto& text) { frames.fps = parse_positive(text); });
  app.add_option("--clip", frames.clip, "Animation, by name or by index from 0 [the first]")
      ->type_name("NAME|INDEX");
  app.add_option("--sequence", frames.sequence,
                 "Files that hold one frame each, added to SCENE, which does not move; * and ? "
                 "match the parts of their names that differ")
      ->type_name("PATTERN");
  add_preload(app, load);
  add_value(app, "--turntable", "N", "Render N images from a camera that circles the scene once",
            [&frames](const auto& text) { frames.turntable = parse_count(text, 1, kMostTurns); });
  app.add_option("--camera-path", frames.camera_path, "Positions of the camera over time")
      ->type_name("FILE.json");
  app.add_flag(
      "--resume", frames.resume,
      "Render only the frames whose files do not exist yet; continue a streamed image that "
      "was interrupted");
}

void check_frames(const RenderCommand& command) {
  const FramesOptions& f = command.frames;
  const bool many = wants_frames(command);
  if (!many && f.resume && !is_streamed(command))
    refuse("--resume", "it is only for frames of a moving scene and for streamed images");
  if (!many) return;
  if (f.time) refuse("--time", "it is for a single image, but frames are requested");
  if (f.turntable != 0 && !f.camera_path.empty())
    refuse("--turntable", "it moves the camera, and so does --camera-path: give only one of them");
  if (!f.camera_path.empty() && !command.options.camera.empty())
    refuse("--camera",
           "it names a camera of the scene, and --camera-path moves another one: give only one of "
           "them");
  if (command.explain) refuse("--explain", "it is for a single image, but frames are requested");
  const bool single = f.range && f.range->first && f.range->first == f.range->last;
  for (const std::string& path : command.pictures) {
    check_name("-o", path, !single);
    if (f.resume && is_film_name(path))
      refuse("--resume", "it cannot continue a film: write images, and make the film from them");
  }
  check_name("--stats", command.stats_path, !single);
  check_name("--heatmap", command.heatmap_path, !single);
}

}  // namespace raysheaf::app
