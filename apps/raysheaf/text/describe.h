// Describes the parser's options in words.
#pragma once

#include <string>

#include "text/command_text.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

/// Describes `app` and the commands below it; `above` is the whole name of its parent.
[[nodiscard]] CommandText describe(const CLI::App& app, const std::string& above = "");

/// The words that `option` takes as its value, whose type is `type`, as "cpu|cuda" or "NAME"; empty
/// if it takes any word.
[[nodiscard]] std::vector<std::string> known_words(const std::string& option,
                                                   const std::string& type);

}  // namespace raysheaf::app
