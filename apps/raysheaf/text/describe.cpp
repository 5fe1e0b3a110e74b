#include "text/describe.h"

#include <CLI/CLI.hpp>

#include "lab/commands/ablation/ablation.h"
#include "lab/commands/compare/words.h"
#include "raysheaf/verify.h"

namespace raysheaf::app {
namespace {

template <typename Values>
std::vector<std::string> names_of(const Values& values) {
  std::vector<std::string> names;
  for (const auto value : values) names.emplace_back(to_string(value));
  return names;
}

/// The words of options whose type is NAME or similar, because there are too many to list there.
std::vector<std::string> words_for(const std::string& option) {
  if (option == "--key" || option == "--keys") return names_of(all_keys());
  if (option == "--bound" || option == "--bounds") return names_of(all_bounds());
  if (option == "--rays") return names_of(all_lab_rays());
  if (option == "--only") return names_of(kPromises);
  if (option == "--kind") return names_of(all_compare_kinds());
  if (option == "--mode") return names_of(all_compare_modes());
  return {};
}

OptionText describe(const CLI::Option& option) {
  OptionText result;
  result.text = option.get_description();
  result.group = option.get_group();
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
  result.words = words_for(result.names.back());
  return result;
}

}  // namespace

std::vector<std::string> known_words(const std::string& option, const std::string& type) {
  const std::vector<std::string> listed = OptionText{{option}, type, "", false, false}.choices();
  return listed.empty() ? words_for(option) : listed;
}

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
