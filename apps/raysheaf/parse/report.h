// `raysheaf report`: its options.
#pragma once

#include <CLI/CLI.hpp>

#include "options.h"

namespace raysheaf::app {

/// `command` must live until the command line is parsed.
CLI::App* add_report(CLI::App& app, ReportCommand& command);

}  // namespace raysheaf::app
