// Scripts that drive the viewer without user input: lines of words, read before anything happens.
//
//   # anything
//   method crsh                a setting and its value, as in the settings file
//   orbit 30 -10               degrees
//   wait-for-refined
//   assert samples-done >= 16
//   screenshot crsh.png
#pragma once

#include <string>
#include <vector>

namespace raysheaf::viewer {

struct ScriptCommand {
  int line = 0;
  /// the command, then its arguments; some commands take any number of them
  std::vector<std::string> words;
};

struct Script {
  std::string file;
  std::vector<ScriptCommand> commands;

  /// "file:line", for errors.
  [[nodiscard]] std::string place(const ScriptCommand& command) const;
};

/// A command and its arguments, for errors and for the documentation.
struct ScriptVerb {
  std::string name, arguments;  ///< names of the arguments; those in brackets are optional
  std::string what;
};
[[nodiscard]] const std::vector<ScriptVerb>& script_verbs();

/// Throws `Error` (kInvalidData, place "file:line") for the first wrong line: an unknown command,
/// too few or too many words, an invalid number, an invalid value of a setting, or an unknown name.
/// A word in double quotes may have spaces.
[[nodiscard]] Script parse_script(const std::string& text, const std::string& file);
/// Also throws kIo.
[[nodiscard]] Script load_script(const std::string& path);

}  // namespace raysheaf::viewer
