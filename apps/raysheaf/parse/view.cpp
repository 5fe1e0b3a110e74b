#include "parse/commands.h"

#include <tuple>

#include "apps/support/values.h"
#include "parse/parts.h"

namespace raysheaf::app {

CLI::App* add_view_command(CLI::App& app, ViewCommand& command) {
  CLI::App* sub = app.add_subcommand("view", "Open a scene in an interactive window");
  add_scene_file(*sub, command.scene, command.load, {.sequences = true, .none = true});
  add_preload(*sub, command.load);
  sub->add_option("--script", command.script_path,
                  "Run the commands in a file, without user input, and exit (docs/viewer.md)")
      ->type_name("FILE");
  sub->add_option(
         "--screenshot", command.screenshot_path,
         "Save the window as an image at the end of the script, or when all samples are done")
      ->type_name("FILE.png");
  sub->add_option("--settings", command.settings_path,
                  "File that keeps the settings of the viewer [the user's own; none with --script "
                  "or --screenshot]")
      ->type_name("FILE");
  add_value(*sub, "--size", "WxH", "Size of the window [that of the last time; 1280x800 at first]",
            [&command](const std::string& text) {
              std::tie(command.width, command.height) = parse_size(text);
            });
  add_value(
      *sub, "--view", "front|back|left|right|top|bottom|iso",
      "Side of the scene that the camera sees first [the view of its own camera, or from above "
      "and from the right]",
      [&command](const auto& text) { command.view = view_from_string(text); });
  add_value(*sub, "--up", "x|y|z|-x|-y|-z",
            "Axis that points up [that of the last time; y at first]",
            [&command](const auto& text) { command.up = up_axis_from_string(text); });
  sub->add_flag("--orthographic", command.orthographic,
                "Begin with parallel rays instead of a perspective");
  add_threads(*sub, command.threads, "Threads that trace, up to 1024; 0 uses all cores [0]");
  sub->footer(
      "Examples:\n"
      "  raysheaf view\n"
      "  raysheaf view builtin:office\n"
      "  raysheaf view model.glb --size 1600x900\n"
      "  raysheaf view part.stl --up z --view front --orthographic\n"
      "  raysheaf view builtin:cornell --screenshot cornell.png\n"
      "  raysheaf view model.glb --script tour.txt");
  sub->callback([&command] {
    if (command.scene.empty() && (command.view || command.orthographic)) {
      throw CLI::ValidationError(command.view ? "--view" : "--orthographic", "needs a scene");
    }
    if (!command.screenshot_path.empty() && !has_ending(command.screenshot_path, ".png")) {
      throw CLI::ValidationError("--screenshot",
                                 "'" + command.screenshot_path + "' does not end in .png");
    }
  });
  return sub;
}

}  // namespace raysheaf::app
