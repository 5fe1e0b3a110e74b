#include "parse/view.h"

#include <tuple>

#include "apps/support/values.h"
#include "parse/parts.h"

namespace raysheaf::app {

CLI::App* add_view_command(CLI::App& app, ViewCommand& command) {
  CLI::App* sub = app.add_subcommand("view", "Open a scene in an interactive window");
  add_scene_file(*sub, command.scene, command.load, {.sequences = true});
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
  add_threads(*sub, command.threads, "Threads that trace, up to 1024; 0 uses all cores [0]");
  sub->footer(
      "Examples:\n"
      "  raysheaf view builtin:office\n"
      "  raysheaf view model.glb --size 1600x900\n"
      "  raysheaf view builtin:cornell --screenshot cornell.png\n"
      "  raysheaf view model.glb --script tour.txt");
  sub->callback([&command] {
    if (!command.screenshot_path.empty() && !has_ending(command.screenshot_path, ".png")) {
      throw CLI::ValidationError("--screenshot",
                                 "'" + command.screenshot_path + "' does not end in .png");
    }
  });
  return sub;
}

}  // namespace raysheaf::app
