// `raysheaf verify` on the command line.
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

CLI::App* add_verify(CLI::App& app, VerifyCommand& command);

}  // namespace raysheaf::app
