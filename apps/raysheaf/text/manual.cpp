// Manual pages, in the macros of man(7).
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "text/command_text.h"

namespace raysheaf::app {
namespace {

/// Escapes text for roff.
std::string roff(const std::string& text) {
  std::string result;
  bool starts_line = true;
  for (const char c : text) {
    if (starts_line && (c == '.' || c == '\'')) result += "\\&";
    starts_line = c == '\n';
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
  }
  return result;
}

std::string page_name(const std::string& command) {
  std::string name = command;
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string synopsis(const CommandText& command) {
  std::string line = fmt::format("\\fB{}\\fR", roff(command.name));
  if (!command.commands.empty()) return line + " \\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n";
  line += " [\\fIOPTIONS\\fR]";
  for (const OptionText& option : command.options) {
    if (!option.positional) continue;
    const std::string name = fmt::format("\\fI{}\\fR", roff(option.names.front()));
    line += option.required ? " " + name : " [" + name + "]";
  }
  return line + "\n";
}

std::string option_paragraph(const OptionText& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.names)
    names.push_back(fmt::format("\\f{}{}\\fR", option.positional ? 'I' : 'B', roff(name)));
  std::string paragraph = fmt::format(".TP\n{}", fmt::join(names, ", "));
  if (!option.positional && !option.value.empty())
    paragraph += fmt::format(" \\fI{}\\fR", roff(option.value));
  return paragraph + "\n" + roff(option.text) + ".\n";
}

std::string options_section(const CommandText& command) {
  std::string section = ".SH OPTIONS\n";
  for (const OptionText& option : command.options)
    if (option.positional) section += option_paragraph(option);
  for (const std::string& group : option_groups(command)) {
    std::string paragraphs;
    for (const OptionText& option : command.options)
      if (!option.positional && option.group == group) paragraphs += option_paragraph(option);
    const bool is_named = group != "Options" && !paragraphs.empty();
    section += (is_named ? ".SS " + roff(group) + "\n" : "") + paragraphs;
  }
  return section;
}

std::string commands_section(const CommandText& command) {
  if (command.commands.empty()) return "";
  std::string section = ".SH COMMANDS\n";
  for (const CommandText& below : command.commands)
    section +=
        fmt::format(".TP\n\\fB{}\\fR(1)\n{}.\n", roff(page_name(below.name)), roff(below.text));
  return section;
}

/// The footer consists of a title, indented lines, and sentences.
std::string examples_section(const CommandText& command) {
  std::string section;
  std::istringstream lines(command.footer);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("  ")) section += roff(line.substr(2)) + "\n";
  return section.empty() ? "" : ".SH EXAMPLES\n.nf\n" + section + ".fi\n";
}

}  // namespace

std::string manual_page(const CommandText& command, const std::string& version) {
  std::string text = command.text;
  while (text.ends_with('.')) text.pop_back();
  std::string page = fmt::format(".TH {} 1 \"\" \"raysheaf {}\" \"User Commands\"\n",
                                 roff(upper(page_name(command.name))), roff(version));
  page += fmt::format(".SH NAME\n{} \\- {}\n", roff(page_name(command.name)), roff(text));
  page += ".SH SYNOPSIS\n" + synopsis(command);
  page += commands_section(command) + options_section(command) + examples_section(command);
  page +=
      ".SH EXIT STATUS\n"
      "0 after success, 1 after a failure, 2 if the command line is wrong, 130 after an "
      "interrupt.\n";
  if (command.name != "raysheaf") page += ".SH SEE ALSO\n\\fBraysheaf\\fR(1)\n";
  return page;
}

}  // namespace raysheaf::app
