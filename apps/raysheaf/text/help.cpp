// Formats help for a terminal.
#include <algorithm>
#include <sstream>

#include "text/command_text.h"

namespace raysheaf::app {
namespace {

constexpr std::size_t kTextColumn = 26, kFewestColumns = 40;
constexpr const char* kLastGroup = "Other";

/// Words of `text` in lines of at most `columns`; a word that is longer is cut. `end` closes each
/// line except the last.
std::vector<std::string> wrapped(const std::string& text, std::size_t columns,
                                 const std::string& end = "") {
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  const std::size_t room = columns - end.size();
  for (std::string word; words >> word;) {
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (line.size() + 1 + word.size() <= room) {
      line += " " + word;
    } else {
      line += end;
      lines.push_back(word);
    }
    while (lines.back().size() > columns) {
      const std::string rest = lines.back().substr(columns);
      lines.back().resize(columns);
      lines.push_back(rest);
    }
  }
  return lines;
}

/// "  NAMES   TEXT": names that are too long for their column have a line of their own.
std::string entry(const std::string& names, const std::string& text, std::size_t columns) {
  std::string all;
  std::size_t at = 0;
  for (const std::string& line : wrapped(names, columns - 4)) {
    all += (all.empty() ? "  " : "\n    ") + line;
    at = (at == 0 ? 2 : 4) + line.size();
  }
  for (const std::string& line : wrapped(text, columns - kTextColumn)) {
    if (at + 2 > kTextColumn) {
      all += "\n";
      at = 0;
    }
    all += std::string(kTextColumn - at, ' ') + line;
    at = kTextColumn;
  }
  return all + "\n";
}

std::string names_and_value(const OptionText& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + name;
  return option.positional || option.value.empty() ? names : names + " " + option.value;
}

std::string option_entry(const OptionText& option, std::size_t columns) {
  const bool says_required = option.required && !option.positional;
  return entry(names_and_value(option), option.text + (says_required ? " (required)" : ""),
               columns);
}

}  // namespace

std::vector<std::string> option_groups(const CommandText& command) {
  std::vector<std::string> groups;
  for (const OptionText& option : command.options) {
    if (option.positional || option.group == kLastGroup) continue;
    if (std::find(groups.begin(), groups.end(), option.group) == groups.end())
      groups.push_back(option.group);
  }
  groups.emplace_back(kLastGroup);
  return groups;
}

namespace {

std::string group_section(const CommandText& command, const std::string& group,
                          std::size_t columns) {
  std::string entries;
  for (const OptionText& option : command.options)
    if (!option.positional && option.group == group) entries += option_entry(option, columns);
  return entries.empty() ? "" : "\n" + group + ":\n" + entries;
}

std::string positional_section(const CommandText& command, std::size_t columns) {
  std::string entries;
  for (const OptionText& option : command.options)
    if (option.positional) entries += option_entry(option, columns);
  return entries.empty() ? "" : "\n" + entries;
}

std::string command_section(const CommandText& command, std::size_t columns) {
  std::string entries;
  for (const CommandText& below : command.commands)
    entries += entry(below.word(), below.text, columns);
  return entries.empty() ? "" : "\nCommands:\n" + entries;
}

/// Indented lines are commands, which a backslash continues on the next line.
std::string footer_section(const std::string& footer, std::size_t columns) {
  if (footer.empty()) return "";
  std::string all = "\n";
  std::istringstream lines(footer);
  for (std::string line; std::getline(lines, line);) {
    const bool is_command = line.starts_with("  ");
    std::string indent = is_command ? "  " : "";
    const std::size_t room = line.size() <= columns ? columns : columns - 6;
    for (const std::string& part : wrapped(line, room, is_command && room < columns ? " \\" : "")) {
      all += part.empty() ? "\n" : indent + part + "\n";
      if (is_command) indent = "      ";
    }
  }
  return all;
}

}  // namespace

std::string usage_line(const CommandText& command) {
  if (!command.commands.empty()) return command.name + " COMMAND [OPTIONS]";
  std::string line = command.name + " [OPTIONS]";
  for (const OptionText& option : command.options) {
    if (!option.positional) continue;
    const std::string& name = option.names.front();
    line += option.required ? " " + name : " [" + name + "]";
  }
  return line;
}

std::string help_text(const CommandText& command, std::size_t columns) {
  columns = std::max(columns, kFewestColumns);
  std::string all;
  for (const std::string& line : wrapped("Usage: " + usage_line(command), columns))
    all += line + "\n";
  all += "\n";
  for (const std::string& line : wrapped(command.text, columns)) all += line + "\n";
  all += positional_section(command, columns) + command_section(command, columns);
  for (const std::string& group : option_groups(command))
    all += group_section(command, group, columns);
  return all + footer_section(command.footer, columns);
}

}  // namespace raysheaf::app
