// Command lines that reproduce a report.
#pragma once

#include <string>

#include "options.h"

namespace raysheaf::app {

/// Quoted for a shell: words that need it are in single quotes.
[[nodiscard]] std::string quoted(const std::string& word);

/// The command line of the report itself.
[[nodiscard]] std::string command_line(const ReportCommand& command);

/// The command line for the image and the statistics of only one of its methods: `render` takes all
/// options of `report` except its outputs and its list of methods.
[[nodiscard]] std::string stats_command_line(const ReportCommand& command, Method method);

}  // namespace raysheaf::app
