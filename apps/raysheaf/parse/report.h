// `raysheaf report`: its options.
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

/// `command` must live until the command line is parsed.
CLI::App* add_report(CLI::App& app, ReportCommand& command);

}  // namespace raysheaf::app
