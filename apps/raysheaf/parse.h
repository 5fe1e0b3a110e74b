// Parses the command line.
#pragma once

#include <variant>

#include "options.h"

namespace raysheaf::app {

/// The command, or the exit code if nothing is left to do, because help or the version was printed,
/// or a usage error was reported on standard error.
[[nodiscard]] std::variant<Command, int> parse(int argc, const char* const* argv);

}  // namespace raysheaf::app
