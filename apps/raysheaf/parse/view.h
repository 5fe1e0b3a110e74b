// `raysheaf view` on the command line.
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

CLI::App* add_view_command(CLI::App& app, ViewCommand& command);

}  // namespace raysheaf::app
