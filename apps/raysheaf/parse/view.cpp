#include "parse/view.h"

#include <tuple>

#include "parse/parts.h"
#include "values.h"

namespace raysheaf::app {

CLI::App* add_view_command(CLI::App& app, ViewCommand& command) {
  CLI::App* sub = app.add_subcommand("view", "Look at a scene, and at how its rays are traced");
  add_scene_file(*sub, command.scene, command.load, {.sequences = true});
  add_preload(*sub, command.load);
  sub->add_option("--script", command.script_path,
                  "Do what the lines of a file say, without hands, and end (docs/viewer.md)")
      ->type_name("FILE");
  sub->add_option("--screenshot", command.screenshot_path,
                  "The window as a picture: at the script's end, or once all samples are there")
      ->type_name("FILE.png");
  sub->add_option("--settings", command.settings_path,
                  "What is remembered from one time to the next [the user's own; none with "
                  "--script or --screenshot]")
      ->type_name("FILE");
  add_value(*sub, "--size", "WxH", "Size of the window [as it was; 1280x800 at first]",
            [&command](const std::string& text) {
              std::tie(command.width, command.height) = parse_size(text);
            });
  add_count(*sub, "--threads", command.threads, 0, 1024,
            "Threads that trace, up to 1024; 0 is all cores [0]");
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
