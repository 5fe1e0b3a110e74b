// The command line in words: what completions and manual pages are made of. No parser in here.
#pragma once

#include <string>
#include <vector>

namespace raysheaf::app {

struct OptionText {
  std::vector<std::string> names;  ///< "-o", "--output"; of a positional its one name, as "SCENE"
  std::string value;               ///< what stands behind it, as "FILE.json"; empty: nothing does
  std::string text;
  bool positional = false, required = false;
  std::vector<std::string> words{};  ///< that it takes, where `value` does not list them

  /// The words that it takes, where they are known: "cpu|cuda" is two.
  [[nodiscard]] std::vector<std::string> choices() const;
  [[nodiscard]] bool takes_folder() const { return value == "DIR"; }
  [[nodiscard]] bool takes_file() const;
};

struct CommandText {
  std::string name;  ///< whole: "raysheaf bench paper"
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

/// A manual page of section 1, in the macros of man(7).
[[nodiscard]] std::string manual_page(const CommandText& command, const std::string& version);

}  // namespace raysheaf::app
