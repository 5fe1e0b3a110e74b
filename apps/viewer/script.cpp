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

/// That a float can be: what plays the script reads it as one.
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
      throw Error(ErrorCode::kInvalidData, "'" + words[i + 1] + "' is no number", place);
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
      {"orbit", "YAW PITCH", "turns round the pivot, in degrees"},
      {"look", "YAW PITCH", "turns the camera, in degrees"},
      {"pan", "RIGHT UP", "moves sidewise, in heights of what is seen"},
      {"zoom", "FACTOR", "of the distance to the pivot"},
      {"fly", "FORWARD RIGHT UP", "in scene units"},
      {"press", "key", "presses a key and lets it go; ctrl+KEY and shift+KEY too"},
      {"hold", "key SECONDS", "holds a key down"},
      {"move", "X Y", "the cursor, in the window from 0 to 1"},
      {"click", "X Y", "presses the left button there"},
      {"drag", "X Y X2 Y2 [button]", "with the left, right or middle button, over 10 frames"},
      {"drop", "file", "as if dropped on the window; waits until it is loaded or refused"},
      {"size", "WIDTH HEIGHT", "of the window"},
      {"play", "", "plays what moves"},
      {"pause", "", "stands still"},
      {"time", "SECONDS", "of what moves"},
      {"clip", "NUMBER", "what is played; 0 is the first"},
      {"wait", "SECONDS", "lets time pass"},
      {"wait-for-picture", "", "waits for a picture of how things are now, of any size"},
      {"wait-for-refined", "[SAMPLES]", "waits for the whole size, and all samples or so many"},
      {"wait-for-bundle", "", "waits for the bundle under the cursor"},
      {"screenshot", "file", "writes the window as PNG"},
      {"save", "file", "writes the picture in full quality as PNG, and waits for it"},
      {"assert", "name comparison value", "ends with an error where it does not hold"},
      {"print", "name", "prints a value"},
      {"measure-latency", "SECONDS [button]",
       "drags by a clock of its own and prints how long input waits for its frame"},
      {"quit", "", "ends"},
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
