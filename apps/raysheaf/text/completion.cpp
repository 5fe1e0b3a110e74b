// Completion scripts for bash, zsh and fish.
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "apps/support/closest.h"
#include "raysheaf/error.h"
#include "text/command_text.h"

namespace raysheaf::app {
namespace {

/// 'text' for a shell that does not interpret text between single quotes.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, " "));
}

std::vector<std::string> words_of(const std::vector<CommandText>& commands) {
  std::vector<std::string> words;
  for (const CommandText& command : commands) words.push_back(command.word());
  return words;
}

/// The commands below, or the values of the positional argument.
std::vector<std::string> next_words(const CommandText& command) {
  std::vector<std::string> words = words_of(command.commands);
  for (const OptionText& option : command.options) {
    if (!option.positional) continue;
    const std::vector<std::string> choices = option.choices();
    words.insert(words.end(), choices.begin(), choices.end());
  }
  return words;
}

std::vector<std::string> option_names(const CommandText& command) {
  std::vector<std::string> names;
  for (const OptionText& option : command.options)
    if (!option.positional) names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

bool has_positionals(const CommandText& command) {
  return std::any_of(command.options.begin(), command.options.end(),
                     [](const OptionText& option) { return option.positional; });
}

/// The cases of bash's function: those that find the command, and those that complete it.
struct BashCases {
  std::string commands, values, words;

  void add(const CommandText& command) {
    for (const CommandText& below : command.commands)
      commands +=
          fmt::format("      \"{0} {1}\") command=\"{0} {1}\" ;;\n", command.name, below.word());
    for (const OptionText& option : command.options) add_value(command, option);
    words +=
        fmt::format("    \"{}\") options={} words={} ;;\n", command.name,
                    quoted(joined(option_names(command))), quoted(joined(next_words(command))));
  }

  void add_value(const CommandText& command, const OptionText& option) {
    if (option.positional || option.value.empty()) return;
    std::vector<std::string> patterns;
    for (const std::string& name : option.names)
      patterns.push_back(fmt::format("\"{} {}\"", command.name, name));
    const std::vector<std::string> choices = option.choices();
    const std::string action = !choices.empty()        ? "compgen -W " + quoted(joined(choices))
                               : option.takes_folder() ? std::string("compgen -d")
                               : option.takes_file()   ? std::string("compgen -f")
                                                       : std::string();
    const std::string reply = action.empty()
                                  ? "COMPREPLY=()"
                                  : fmt::format("mapfile -t COMPREPLY < <({} -- \"$cur\")", action);
    values += fmt::format("    {}) {}; return ;;\n", fmt::join(patterns, " | "), reply);
  }
};

std::string bash_script(const CommandText& raysheaf) {
  BashCases cases;
  for_each_command(raysheaf, [&](const CommandText& command) { cases.add(command); });
  return fmt::format(R"(# bash completion for raysheaf
_raysheaf() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD - 1]}}
  local command=raysheaf options words i
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "$command ${{COMP_WORDS[i]}}" in
{}    esac
  done
  case "$command $prev" in
{}  esac
  case "$command" in
{}  esac
  if [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$cur")
  elif [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$cur")
  fi
}}
complete -o filenames -F _raysheaf raysheaf
)",
                     cases.commands, cases.values, cases.words);
}

/// Text within zsh's [ ] or after its colons.
std::string zsh_text(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
    result += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return result;
}

std::string zsh_value(const OptionText& option) {
  if (option.value.empty()) return "";
  const std::vector<std::string> choices = option.choices();
  const std::string action = !choices.empty()        ? "(" + joined(choices) + ")"
                             : option.takes_folder() ? std::string("_files -/")
                             : option.takes_file()   ? std::string("_files")
                                                     : std::string();
  return ":" + zsh_text(option.value) + ":" + action;
}

std::string zsh_function(const std::string& name) {
  std::string result = "_" + name;
  std::replace(result.begin(), result.end(), ' ', '_');
  return result;
}

std::string zsh_arguments(const CommandText& command) {
  std::string lines;
  for (const OptionText& option : command.options) {
    if (option.positional) continue;
    for (const std::string& name : option.names)
      lines += fmt::format(" \\\n    '*{}[{}]{}'", name, zsh_text(option.text), zsh_value(option));
  }
  if (!command.commands.empty()) return lines + " \\\n    '1: :->command' '*:: :->rest'";
  const std::vector<std::string> words = next_words(command);
  if (!words.empty()) return lines + fmt::format(" \\\n    '1: :({})'", joined(words));
  if (has_positionals(command)) lines += " \\\n    '*: :_files'";
  return lines;
}

std::string zsh_script(const CommandText& raysheaf) {
  std::string script = "#compdef raysheaf\n";
  for_each_command(raysheaf, [&](const CommandText& command) {
    script += fmt::format("\n{}() {{\n", zsh_function(command.name));
    if (!command.commands.empty()) script += "  local state\n";
    script += fmt::format("  _arguments{}\n", zsh_arguments(command));
    if (!command.commands.empty()) {
      script += "  case $state in\n    command)\n      local -a commands=(\n";
      for (const CommandText& below : command.commands)
        script += fmt::format("        '{}:{}'\n", below.word(), zsh_text(below.text));
      script +=
          "      )\n      _describe command commands ;;\n    rest)\n      case $words[1] in\n";
      for (const CommandText& below : command.commands)
        script += fmt::format("        {}) {} ;;\n", below.word(), zsh_function(below.name));
      script += "      esac ;;\n  esac\n";
    }
    script += "}\n";
  });
  return script +
         "\nif [[ $funcstack[1] == _raysheaf ]]; then\n"
         "  _raysheaf \"$@\"\n"
         "else\n"
         "  compdef _raysheaf raysheaf\n"
         "fi\n";
}

/// The words that must have been typed, and those that must not, for `command` to be completed.
std::string fish_condition(const CommandText& command) {
  const auto seen = [](const std::vector<std::string>& words) {
    return "__fish_seen_subcommand_from " + joined(words);
  };
  std::string condition = command.name == "raysheaf" ? "" : seen({command.word()});
  if (!command.commands.empty())
    condition += (condition.empty() ? "not " : "; and not ") + seen(words_of(command.commands));
  return condition;
}

std::string fish_option(const CommandText& command, const OptionText& option) {
  std::string line = "complete -c raysheaf -n " + quoted(fish_condition(command));
  for (const std::string& name : option.names)
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!option.value.empty()) {
    const std::vector<std::string> choices = option.choices();
    if (!choices.empty())
      line += " -x -a " + quoted(joined(choices));
    else if (option.takes_folder())
      line += " -x -a '(__fish_complete_directories)'";
    else
      line += option.takes_file() ? " -r -F" : " -x";
  }
  return line + " -d " + quoted(option.text) + "\n";
}

std::string fish_script(const CommandText& raysheaf) {
  std::string script = "# fish completion for raysheaf\n";
  for_each_command(raysheaf, [&](const CommandText& command) {
    for (const CommandText& below : command.commands)
      script += fmt::format("complete -c raysheaf -f -n {} -a {} -d {}\n",
                            quoted(fish_condition(command)), below.word(), quoted(below.text));
    const std::vector<std::string> words = next_words(command);
    if (command.commands.empty() && !words.empty())
      script += fmt::format("complete -c raysheaf -f -n {} -a {}\n",
                            quoted(fish_condition(command)), quoted(joined(words)));
    for (const OptionText& option : command.options)
      if (!option.positional) script += fish_option(command, option);
  });
  return script;
}

}  // namespace

std::vector<std::string> OptionText::choices() const {
  if (!words.empty()) return words;
  const auto belongs = [](unsigned char c) {
    return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '|' || c == '_' || c == '-';
  };
  if (value.find('|') == std::string::npos || !std::all_of(value.begin(), value.end(), belongs))
    return {};
  std::vector<std::string> listed{""};
  for (const char c : value) {
    if (c == '|')
      listed.emplace_back();
    else
      listed.back() += c;
  }
  return listed;
}

bool OptionText::takes_file() const {
  return value.starts_with("FILE") || value == "SCENE";
}

std::string completion_script(const CommandText& raysheaf, const std::string& shell) {
  if (shell == "bash") return bash_script(raysheaf);
  if (shell == "zsh") return zsh_script(raysheaf);
  if (shell == "fish") return fish_script(raysheaf);
  throw Error(ErrorCode::kInvalidArgument,
              "'" + shell + "' is neither bash nor zsh nor fish" +
                  did_you_mean(shell, {"bash", "zsh", "fish"}),
              "completion SHELL");
}

}  // namespace raysheaf::app
