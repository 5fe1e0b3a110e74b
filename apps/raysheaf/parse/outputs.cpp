#include "parse/commands.h"

#include <algorithm>

#include "apps/support/values.h"
#include "parse/parts.h"
#include "raysheaf/backdrop.h"
#include "render/default_output.h"
#include "render/files.h"
#include "render/film.h"
#include "render/frames_command.h"
#include "render/picture.h"

namespace raysheaf::app {
namespace {

bool is_jpeg_name(const std::string& path) {
  return has_ending(path, ".jpg") || has_ending(path, ".jpeg");
}

bool has_picture_ending(const std::string& path) {
  return has_ending(path, ".png") || has_ending(path, ".exr") || is_film_name(path) ||
         is_jpeg_name(path) || path == kStandardOutput;
}

[[noreturn]] void refuse_output_option(const std::string& option, const std::string& sentence) {
  throw CLI::ValidationError(option, sentence);
}

void check_standard_output(const RenderCommand& command) {
  const auto count = std::count(command.pictures.begin(), command.pictures.end(), kStandardOutput);
  const bool stats = command.stats_path == kStandardOutput;
  if (count == 0 && !stats) return;
  const std::string first = stats ? "--stats" : "-o", what = stats ? "JSON" : "image";
  if (count > 1) refuse_output_option("-o", "'-' is given twice");
  if (count > 0 && stats)
    refuse_output_option("--stats", "it would mix with the image that -o - writes: give a file");
  if (command.explain)
    refuse_output_option("--explain",
                         "it would mix with the " + what + " that " + first + " - writes");
  if (wants_frames(command))
    refuse_output_option(first, "'-' is for a single image, but frames are requested");
}

}  // namespace

void add_outputs(CLI::App& app, RenderCommand& command) {
  begin_group(app, kCommonGroup);
  app.add_option("-o,--output", command.pictures,
                 "Image (.png, .jpg, or .exr with layers; %d or %04d stands for a frame's number) "
                 "or film (.mp4, .webp), once or more; - is a PNG on standard output [SCENE.png]")
      ->type_name("FILE")
      ->take_all()
      ->allow_extra_args(false);
}

void add_other_outputs(CLI::App& app, RenderCommand& command) {
  begin_group(app, kOutputGroup);
  add_value(app, "--background", "white|black|transparent|#RRGGBB",
            "Colour behind the scene, in sRGB [the sky]",
            [&command](const auto& text) { command.background = background_from_string(text); });
  app.add_flag("--ground", command.ground,
               "Let the model cast its shadow on a ground below it, square to --up and otherwise "
               "invisible");
  app.add_option("--stats", command.stats_path,
                 "Write statistics as JSON, to standard output if the name is -")
      ->type_name("FILE.json");
  app.add_option("--heatmap", command.heatmap_path,
                 "Write the intersection tests of each pixel as an image with a legend")
      ->type_name("FILE.png");
  app.add_flag("--explain", command.explain,
               "For each batch of rays, print what dual chose and why, the numbers of box and "
               "triangle tests, and times");
  add_quiet(app, command.quiet, "Show no progress bar, warnings or summary");
}

void check_outputs(const RenderCommand& command) {
  for (const std::string& path : command.pictures) {
    refuse_folder(path, default_picture(command.scene));
    if (!has_picture_ending(path)) {
      refuse_output_option("-o", "'" + path +
                                     "' ends in none of .png, .jpg, .exr, .mp4 and .webp, "
                                     "and is not -, which stands for standard output");
    }
    const bool is_opaque = is_jpeg_name(path) || has_ending(path, ".mp4");
    if (is_opaque && command.background && command.background->back() == 0)
      refuse_output_option("--background", "'" + path + "' cannot be transparent");
  }
  check_standard_output(command);
  if (!command.heatmap_path.empty() && !has_ending(command.heatmap_path, ".png"))
    refuse_output_option("--heatmap", "'" + command.heatmap_path + "' does not end in .png");
  if (writes_nothing(command) && wants_frames(command)) {
    refuse_output_option("render",
                         "there is nothing to write: give -o, --stats or --heatmap with a place "
                         "for the frame's number, as in frame_%04d.png");
  }
}

}  // namespace raysheaf::app
