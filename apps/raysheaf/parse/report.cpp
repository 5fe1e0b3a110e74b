#include "parse/report.h"

#include <algorithm>

#include "parse/parts.h"
#include "values.h"

namespace raysheaf::app {
namespace {

void add_methods(CLI::App& app, std::vector<Method>& methods) {
  const std::string option = "--method";
  app.add_option_function<std::vector<std::string>>(
         option,
         [&methods, option](const std::vector<std::string>& names) {
           for (const std::string& name : names)
             into(
                 [&](const std::string& given) {
                   const Method method = method_from_string(given);
                   if (std::find(methods.begin(), methods.end(), method) == methods.end())
                     methods.push_back(method);
                 },
                 option)(name);
         },
         "A method to run; may be given more than once [all; brute is counted, not run, where it "
         "is slow]")
      ->type_name("brute|rah|crsh|gl10|dual")
      ->allow_extra_args(false);
}

}  // namespace

CLI::App* add_report(CLI::App& app, ReportCommand& command) {
  CLI::App* sub = app.add_subcommand(
      "report", "Run every method on a scene and write a page about it that needs nothing else");
  add_scene_file(*sub, command.scene, command.load, {});
  sub->add_option("-o,--output", command.output, "The page")->type_name("FILE.html")->required();
  sub->add_flag("-q,--quiet", command.quiet, "No progress bar, warnings or summary");
  add_methods(*sub, command.methods);
  add_view(*sub, command.options);
  add_rays(*sub, command.options);
  add_settings(*sub, command.options);
  sub->footer(
      "Examples:\n"
      "  raysheaf report builtin:office -o office.html\n"
      "  raysheaf report model.glb -o model.html --size 1024x768 --camera 1 --bounces 1\n"
      "  raysheaf report builtin:atrium -o rah.html --method rah --method dual");
  sub->callback([&command] {
    if (!has_ending(command.output, ".html") && !has_ending(command.output, ".htm"))
      throw CLI::ValidationError("-o", "'" + command.output + "' does not end in .html");
  });
  return sub;
}

}  // namespace raysheaf::app
