#include "report/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace raysheaf::app {
namespace {

/// The use of a word of `report` in a command line of `render`.
enum class Fate { kKept, kDropped, kDroppedWithTheNext };

Fate fate_of(const std::string& word) {
  for (const std::string option : {"--output", "--method"}) {
    if (word == option) return Fate::kDroppedWithTheNext;
    if (word.starts_with(option + "=")) return Fate::kDropped;
  }
  if (word == "--quiet") return Fate::kDropped;
  // "-q", "-o", "-oFILE", "-qo"
  if (word.size() < 2 || word[0] != '-' || (word[1] != 'q' && word[1] != 'o')) return Fate::kKept;
  return word.find('o') == word.size() - 1 ? Fate::kDroppedWithTheNext : Fate::kDropped;
}

}  // namespace

std::string quoted(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_-./:,=+@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string command_line(const ReportCommand& command) {
  std::string text = "raysheaf report";
  for (const std::string& word : command.words) text += " " + quoted(word);
  return text;
}

std::string stats_command_line(const ReportCommand& command, Method method) {
  std::string text = "raysheaf render";
  for (std::size_t i = 0; i < command.words.size(); ++i) {
    const Fate fate = fate_of(command.words[i]);
    if (fate == Fate::kKept) text += " " + quoted(command.words[i]);
    if (fate == Fate::kDroppedWithTheNext) ++i;
  }
  return text + fmt::format(" --method {0} -o {0}.png --stats {0}.json", to_string(method));
}

}  // namespace raysheaf::app
