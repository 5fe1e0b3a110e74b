#include "script.h"

#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "raysheaf/error.h"
#include "view_settings.h"

namespace raysheaf::viewer {
namespace {

std::vector<std::string> words_of(const std::string& line, const std::string& place) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < line.size();) {
    if (std::isspace(static_cast<unsigned char>(line[i])) != 0) {
      ++i;
    } else if (line[i] == '#') {
      break;
    } else if (line[i] == '"') {
      const std::size_t end = line.find('"', i + 1);
      if (end == std::string::npos)
        throw Error(ErrorCode::kInvalidData, "a quotation mark is not closed", place);
      words.push_back(line.substr(i + 1, end - i - 1));
      i = end + 1;
    } else {
      const std::size_t end = std::min(line.find_first_of(" \t\r", i), line.size());
      words.push_back(line.substr(i, end - i));
      i = end;
    }
  }
  return words;
}

std::vector<std::string> split(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// Whether it fits into a float, because the player reads it as one.
bool is_number(const std::string& text) {
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
}

bool is_comparison(const std::string& word) {
  for (const char* known : {"<", "<=", ">", ">=", "is", "is-not", "contains"})
    if (word == known) return true;
  return false;
}

const ScriptVerb* find_verb(const std::string& name) {
  for (const ScriptVerb& verb : script_verbs())
    if (verb.name == name) return &verb;
  return nullptr;
}

std::string verb_names() {
  std::string names;
  for (const ScriptVerb& verb : script_verbs()) names += (names.empty() ? "" : ", ") + verb.name;
  return names;
}

/// Arguments whose names are in capitals are numbers.
bool wants_number(const std::string& argument) {
  const char first = argument[0] == '[' ? argument[1] : argument[0];
  return first >= 'A' && first <= 'Z';
}

void check_verb(const ScriptVerb& verb, const std::vector<std::string>& words,
                const std::string& place) {
  const std::vector<std::string> wanted = split(verb.arguments);
  std::size_t least = 0;
  for (const std::string& argument : wanted) least += argument[0] == '[' ? 0u : 1u;
  const std::size_t given = words.size() - 1;
  if (given < least || given > wanted.size())
    throw Error(ErrorCode::kInvalidData,
                wanted.empty() ? "'" + verb.name + "' takes nothing"
                               : "'" + verb.name + "' takes: " + verb.arguments,
                place);
  for (std::size_t i = 0; i < given; ++i) {
    if (wants_number(wanted[i]) && !is_number(words[i + 1]))
      throw Error(ErrorCode::kInvalidData, "'" + words[i + 1] + "' is not a number", place);
    if (wanted[i] == "comparison" && !is_comparison(words[i + 1]))
      throw Error(ErrorCode::kInvalidData,
                  "'" + words[i + 1] + "' is none of <, <=, >, >=, is, is-not, contains", place);
  }
}

void check_setting(const SettingField& field, const std::vector<std::string>& words,
                   const std::string& place) {
  if (words.size() != 2)
    throw Error(ErrorCode::kInvalidData, "'" + field.name + "' takes one value", place);
  try {
    ViewSettings scratch;
    field.set(scratch, words[1]);
  } catch (const Error& error) {
    throw Error(ErrorCode::kInvalidData, field.name + " " + error.sentence(), place);
  }
}

}  // namespace

const std::vector<ScriptVerb>& script_verbs() {
  static const std::vector<ScriptVerb> verbs = {
      {"orbit", "YAW PITCH", "orbits around the pivot, in degrees"},
      {"look", "YAW PITCH", "turns the camera, in degrees"},
      {"pan", "RIGHT UP", "moves sideways, in units of the visible height"},
      {"zoom", "FACTOR", "multiplies the distance to the pivot"},
      {"fly", "FORWARD RIGHT UP", "moves, in scene units"},
      {"press", "key", "presses and releases a key; also ctrl+KEY and shift+KEY"},
      {"hold", "key SECONDS", "holds a key down"},
      {"move", "X Y", "moves the cursor, in the window from 0 to 1"},
      {"click", "X Y", "presses the left button there"},
      {"drag", "X Y X2 Y2 [button]", "drags with the left, right or middle button, over 10 frames"},
      {"drop", "file",
       "opens a file as if it was dropped on the window; waits until it is loaded or refused"},
      {"size", "WIDTH HEIGHT", "sets the size of the window"},
      {"play", "", "plays the animation"},
      {"pause", "", "pauses the animation"},
      {"time", "SECONDS", "sets the time of the animation"},
      {"clip", "NUMBER", "selects the animation; 0 is the first"},
      {"wait", "SECONDS", "waits for this time"},
      {"wait-for-picture", "", "waits for an image of the current state, of any size"},
      {"wait-for-refined", "[SAMPLES]",
       "waits for the full size, and for all samples or this number"},
      {"wait-for-bundle", "", "waits for the bundle under the cursor"},
      {"screenshot", "file", "writes the window as PNG"},
      {"save", "file", "writes the image in full quality as PNG, and waits for it"},
      {"assert", "name comparison value", "ends with an error if the comparison fails"},
      {"print", "name", "prints a value"},
      {"measure-latency", "SECONDS [button]",
       "drags by a separate clock and prints the time from input to its frame"},
      {"quit", "", "closes the viewer"},
  };
  return verbs;
}

std::string Script::place(const ScriptCommand& command) const {
  return file + ":" + std::to_string(command.line);
}

Script parse_script(const std::string& text, const std::string& file) {
  Script script{file, {}};
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ScriptCommand command{++number, {}};
    const std::string place = script.place(command);
    command.words = words_of(line, place);
    if (command.words.empty()) continue;
    const std::string& name = command.words[0];
    if (const ScriptVerb* verb = find_verb(name)) {
      check_verb(*verb, command.words, place);
    } else if (const SettingField* field = find_setting(name)) {
      check_setting(*field, command.words, place);
    } else {
      throw Error(ErrorCode::kInvalidData,
                  "'" + name + "' is neither a setting nor one of " + verb_names(), place);
    }
    script.commands.push_back(std::move(command));
  }
  return script;
}

Script load_script(const std::string& path) {
  std::error_code failed;
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path, failed))
    throw Error(ErrorCode::kIo, "cannot be read", path);
  std::ostringstream text;
  text << file.rdbuf();
  return parse_script(text.str(), path);
}

}  // namespace raysheaf::viewer
