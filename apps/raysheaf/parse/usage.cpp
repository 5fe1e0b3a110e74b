#include "parse/usage.h"

#include <algorithm>

#include "apps/support/closest.h"
#include "apps/support/console.h"
#include "options.h"
#include "text/describe.h"

namespace raysheaf::app {
namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : commands_of(app)) names.push_back(sub->get_name());
  return names;
}

std::vector<std::string> names_of_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// "raysheaf bench paper".
std::string whole_name(const CLI::App& app) {
  const CLI::App* above = app.get_parent();
  return above == nullptr ? app.get_name() : whole_name(*above) + " " + app.get_name();
}

std::string joined_names(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

/// Reports that `word` names no command of `app`, or that the word is missing if it is empty.
void report_no_command(const std::string& word, const CLI::App& app) {
  const std::string of = app.get_parent() == nullptr ? "" : " of " + app.get_name();
  const std::vector<std::string> names = names_of_commands(app);
  const std::string what = word.empty() ? "give a command" : "'" + word + "' is not a command";
  const std::string hint = did_you_mean(word, names);
  tell_error(what + of + (hint.empty() ? "; the commands are " + joined_names(names) : hint) +
             " (see " + whole_name(app) + " --help)");
}

/// The command that was parsed, below `app`.
const CLI::App& parsed_command(const CLI::App& app) {
  const std::vector<CLI::App*> parsed = app.get_subcommands();
  return parsed.empty() ? app : parsed_command(*parsed.front());
}

/// Names that other renderers and tools give to what an option of raysheaf does.
struct OtherName {
  const char* option;  ///< the hint appears only where a command has this option
  const char* hint;
  std::vector<const char*> names;
};

const std::vector<OtherName>& other_names() {
  static const std::vector<OtherName> kNames = {
      {"--version", "-V prints the version", {"-v"}},
      {"--quiet",
       "progress and a summary are printed without an option, and -q turns them off",
       {"-v", "-vv", "--verbose", "--progress", "--debug"}},
      {"--size",
       "give both sides, as in --size 640x480",
       {"--width", "--height", "-w", "-W", "-H", "-r", "-s", "--res", "--resolution",
        "--dimensions", "--image-size"}},
      {"--samples",
       "give --samples N",
       {"-n", "--spp", "--samples-per-pixel", "--pixel-samples", "--aa", "--antialias"}},
      {"--output", "give -o FILE", {"--out", "-out", "--outfile", "--image", "--save", "--to"}},
      {"--background", "give --background COLOUR", {"--bg", "--bgcolor", "--background-color"}},
      {"--env",
       "give --env FILE",
       {"--hdri", "--hdr", "--environment", "--envmap", "--env-map", "--skybox", "--ibl"}},
      {"--bounces", "give --bounces N", {"--max-depth", "--depth", "--max-bounces", "--ray-depth"}},
      {"--orthographic", "give --orthographic", {"--ortho", "--parallel"}},
      {"--camera-position",
       "give --camera-position X,Y,Z",
       {"--eye", "--from", "--position", "--origin", "--camera-pos"}},
      {"--look-at", "give --look-at X,Y,Z", {"--target", "--at", "--lookat", "--center"}},
      {"--threads",
       "give --threads N",
       {"-j", "-t", "--jobs", "--num-threads", "--nthreads", "--workers"}},
      {"--device", "give --device cuda", {"--gpu", "--cuda", "--use-gpu"}},
      {"--fps", "give --fps F", {"--framerate", "--frame-rate"}},
      {"--up", "give --up z", {"--z-up", "--zup"}},
      {"",
       "the scene is given without an option",
       {"-i", "-f", "--input", "--file", "--scene", "--mesh"}},
  };
  return kNames;
}

/// "; give --size 640x480" if `word` is such a name, else the closest of the command's options.
std::string hint_for(const std::string& word, const CLI::App& command) {
  for (const OtherName& other : other_names()) {
    const bool fits = *other.option != 0 ? command.get_option_no_throw(other.option) != nullptr
                                         : command.get_option_no_throw("SCENE") != nullptr;
    if (fits && std::find(other.names.begin(), other.names.end(), word) != other.names.end())
      return std::string("; ") + other.hint;
  }
  return did_you_mean(word, names_of_options(command));
}

/// A sentence about the arguments that the command does not take.
std::string unexpected(const CLI::App& app, const CLI::App& command) {
  const std::vector<std::string> words = app.remaining(true);
  const std::string first = words.empty() ? "" : words.front();
  if (first.starts_with("-")) {
    const std::string name = first.substr(0, first.find('='));
    return "'" + name + "' is not an option of " + whole_name(command) + hint_for(name, command);
  }
  std::string sentence = whole_name(command) + " does not take";
  for (const std::string& word : words) sentence += " '" + word + "'";
  return sentence;
}

}  // namespace

void format_help(CLI::App& app) {
  app.formatter_fn([](const CLI::App* command, const std::string&, CLI::AppFormatMode) {
    return help_text(*command);
  });
}

std::string help_text(const CLI::App& command) {
  const CLI::App* above = command.get_parent();
  return help_text(describe(command, above == nullptr ? "" : whole_name(*above)), output_columns());
}

CLI::App* add_help(CLI::App& app, std::vector<std::string>& words) {
  std::string names;
  for (const std::string& name : names_of_commands(app)) names += (names.empty() ? "" : "|") + name;
  CLI::App* sub = app.add_subcommand("help", "Print the help of a command");
  sub->add_option("COMMAND", words, "The command, as in 'raysheaf help bench paper'")
      ->type_name(names);
  sub->footer(
      "Examples:\n"
      "  raysheaf help render\n"
      "  raysheaf help bench compare");
  return sub;
}

const CLI::App* find_command(std::span<const std::string> words, const CLI::App& app) {
  if (words.empty()) return &app;
  for (const CLI::App* sub : commands_of(app))
    if (sub->get_name() == words.front()) return find_command(words.subspan(1), *sub);
  if (commands_of(app).empty())
    tell_error(whole_name(app) + " has no commands of its own, and no '" + words.front() + "'");
  else
    report_no_command(words.front(), app);
  return nullptr;
}

bool starts_well(std::span<const char* const> words, const CLI::App& app) {
  const std::vector<const CLI::App*> commands = commands_of(app);
  const std::string first = words.empty() ? "" : words.front();
  if (commands.empty() || first.starts_with("-")) return true;
  for (const CLI::App* sub : commands)
    if (sub->get_name() == first) return starts_well(words.subspan(1), *sub);
  report_no_command(first, app);
  return false;
}

int report_usage_error(const CLI::ParseError& error, const CLI::App& app) {
  const CLI::App& command = parsed_command(app);
  // Without a command, CLI11 reports that before an unknown option.
  const bool extras = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
                      (&command == &app && !app.remaining().empty());
  std::string sentence = extras ? unexpected(app, command) : error.what();
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');  // CLI11's may have line breaks
  tell_error(sentence + " (see " + whole_name(command) + " --help)");
  return kUsage;
}

}  // namespace raysheaf::app
