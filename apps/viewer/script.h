// A viewer without hands: lines of words, read before anything happens.
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
  std::vector<std::string> words;  ///< the command, then what it takes; as many as it wants
};

struct Script {
  std::string file;
  std::vector<ScriptCommand> commands;

  /// "file:line", for errors.
  [[nodiscard]] std::string place(const ScriptCommand& command) const;
};

/// A command and what it takes, for errors and for the documentation.
struct ScriptVerb {
  std::string name, arguments;  ///< arguments by name; one in brackets may be left out
  std::string what;
};
[[nodiscard]] const std::vector<ScriptVerb>& script_verbs();

/// Throws `Error` (kInvalidData, place "file:line") for the first line that is wrong: no such
/// command, too few or too many words, a number that is none, a value that a setting does not take,
/// a name that nothing is called. A word in double quotes may have spaces.
[[nodiscard]] Script parse_script(const std::string& text, const std::string& file);
/// Throws kIo too.
[[nodiscard]] Script load_script(const std::string& path);

}  // namespace raysheaf::viewer
