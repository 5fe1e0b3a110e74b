// The command line in words, for help, completions and manual pages. No parser is included here.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace raysheaf::app {

struct OptionText {
  std::vector<std::string> names;  ///< "-o", "--output"; a positional has one, as "SCENE"
  std::string value;               ///< the name of its value, as "FILE.json"; empty without one
  std::string text;
  bool positional = false, required = false;
  std::vector<std::string> words{};  ///< that it takes, if `value` does not list them
  std::string group = "Options";     ///< its heading in the help

  /// The words that it takes, if they are known: "cpu|cuda" is two.
  [[nodiscard]] std::vector<std::string> choices() const;
  [[nodiscard]] bool takes_folder() const { return value == "DIR"; }
  [[nodiscard]] bool takes_file() const;
};

struct CommandText {
  std::string name;  ///< whole name: "raysheaf bench paper"
  std::string text, footer;
  std::vector<OptionText> options;
  std::vector<CommandText> commands;

  /// The last word of the name.
  [[nodiscard]] std::string word() const { return name.substr(name.rfind(' ') + 1); }
};

/// `visit` is called for a command and all below it, in order.
template <typename Visit>
void for_each_command(const CommandText& command, const Visit& visit) {
  visit(command);
  for (const CommandText& below : command.commands) for_each_command(below, visit);
}

/// A script that completes the command line of "bash", "zsh" or "fish". Throws `Error`
/// (kInvalidArgument) for any other shell.
[[nodiscard]] std::string completion_script(const CommandText& raysheaf, const std::string& shell);

/// Headings of the command's options, in the order in which they were added, "Other" last.
[[nodiscard]] std::vector<std::string> option_groups(const CommandText& command);

/// "raysheaf info [OPTIONS] SCENE".
[[nodiscard]] std::string usage_line(const CommandText& command);

/// Usage, options in groups, examples; no line is longer than `columns`, or 40 if that is more.
[[nodiscard]] std::string help_text(const CommandText& command, std::size_t columns);

/// A manual page of section 1, in the macros of man(7).
[[nodiscard]] std::string manual_page(const CommandText& command, const std::string& version);

}  // namespace raysheaf::app
