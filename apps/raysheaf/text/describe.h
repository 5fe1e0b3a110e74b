// From the parser to words.
#pragma once

#include <string>

#include "text/command_text.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

/// `app` and the commands below it; `above` is the name of what it belongs to.
[[nodiscard]] CommandText describe(const CLI::App& app, const std::string& above = "");

}  // namespace raysheaf::app
