#include "parse/commands.h"

#include "apps/support/values.h"
#include "parse/parts.h"

namespace raysheaf::app {
CLI::App* add_report(CLI::App& app, ReportCommand& command) {
  CLI::App* sub = app.add_subcommand(
      "report", "Run every method on a scene and write a self-contained page about it");
  use_groups(*sub);
  add_scene_file(*sub, command.scene, command.load, {});
  begin_group(*sub, kCommonGroup);
  sub->add_option("-o,--output", command.output, "The page")->type_name("FILE.html")->required();
  add_size(*sub, command.options);
  add_exposure(*sub, command.options);
  add_quiet(*sub, command.quiet, "Show no progress bar, warnings or summary");
  add_camera(*sub, command.options);
  add_rays(*sub, command.options);
  begin_group(*sub, kMethodGroup);
  add_words(
      *sub, "--method",
      "A method to run; may be given more than once [all; the tests of brute are computed without "
      "running it if it is slow]",
      "brute|rah|crsh|gl10|dual", command.methods,
      [](const std::string& name) { return method_from_string(name); });
  add_settings(*sub, command.options);
  sub->footer(
      "Examples:\n"
      "  raysheaf report builtin:office -o office.html\n"
      "  raysheaf report model.glb -o model.html --size 1024x768 --bounces 1\n"
      "  raysheaf report builtin:atrium -o rah.html --method rah --method dual");
  sub->callback([sub, &command] {
    shape_as_camera(*sub, &command.options);
    if (!command.methods.empty()) check_method_settings(*sub, command.methods);
    if (!command.options.reflections && !command.options.refractions)
      refuse_without_effect(*sub, "--bounces", "no reflections and no refractions are traced");
    refuse_folder(command.output, "report.html");
    if (!has_ending(command.output, ".html") && !has_ending(command.output, ".htm"))
      throw CLI::ValidationError("-o", "'" + command.output + "' does not end in .html");
  });
  return sub;
}

}  // namespace raysheaf::app
