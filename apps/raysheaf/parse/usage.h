// Help, and sentences about command lines that cannot be understood.
#pragma once

#include <CLI/CLI.hpp>

#include <span>
#include <string>
#include <vector>

namespace raysheaf::app {

/// Makes `app`, and every command that is added to it later, print help in groups, wrapped to the
/// terminal's width.
void format_help(CLI::App& app);

/// The help of `command`, whichever command was parsed.
[[nodiscard]] std::string help_text(const CLI::App& command);

/// `raysheaf help [COMMAND]...`. Call it after all other commands were added to `app`.
CLI::App* add_help(CLI::App& app, std::vector<std::string>& words);

/// The command that `words` name, or `app` itself without words. If `words` name no command,
/// reports that on standard error and returns null.
[[nodiscard]] const CLI::App* find_command(std::span<const std::string> words, const CLI::App& app);

/// Whether `words` begin with a command of `app`, and with a command of that one if it has any, or
/// with an option. If not, reports which commands exist.
[[nodiscard]] bool starts_well(std::span<const char* const> words, const CLI::App& app);

/// Reports `error` in one line on standard error and returns the exit code. `app` is the program.
int report_usage_error(const CLI::ParseError& error, const CLI::App& app);

}  // namespace raysheaf::app
