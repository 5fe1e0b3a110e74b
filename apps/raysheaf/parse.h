// The command line as text, and what it means.
#pragma once

#include <variant>

#include "options.h"

namespace raysheaf::app {

/// The command, or the exit code where there is nothing left to do: help and version have been
/// printed, or a usage error has been told on stderr.
[[nodiscard]] std::variant<Command, int> parse(int argc, const char* const* argv);

}  // namespace raysheaf::app
