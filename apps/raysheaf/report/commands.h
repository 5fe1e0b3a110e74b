// Command lines that do again what a report tells of.
#pragma once

#include <string>

#include "options.h"

namespace raysheaf::app {

/// As a shell takes it: words that need it stand in single quotes.
[[nodiscard]] std::string quoted(const std::string& word);

/// The report itself, as it was asked for.
[[nodiscard]] std::string command_line(const ReportCommand& command);

/// The picture and the statistics of one of its methods, alone: `render` takes all options of
/// `report` but its outputs and its list of methods.
[[nodiscard]] std::string stats_command_line(const ReportCommand& command, Method method);

}  // namespace raysheaf::app
