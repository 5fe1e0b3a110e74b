#include "text/describe.h"

#include <CLI/CLI.hpp>

namespace raysheaf::app {
namespace {

OptionText describe(const CLI::Option& option) {
  OptionText result;
  result.text = option.get_description();
  result.required = option.get_required();
  result.positional = option.get_positional();
  if (result.positional) {
    result.names = {option.get_name(true)};
    result.value = option.get_type_name() != "TEXT" ? option.get_type_name() : result.names.front();
    return result;
  }
  for (const std::string& name : option.get_snames()) result.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) result.names.push_back("--" + name);
  if (option.get_type_size_max() > 0) result.value = option.get_type_name();
  return result;
}

}  // namespace

CommandText describe(const CLI::App& app, const std::string& above) {
  CommandText result;
  result.name = above.empty() ? app.get_name() : above + " " + app.get_name();
  result.text = app.get_description();
  result.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) result.options.push_back(describe(*option));
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    result.commands.push_back(describe(*sub, result.name));
  return result;
}

}  // namespace raysheaf::app
