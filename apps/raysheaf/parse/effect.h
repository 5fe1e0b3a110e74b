// Options of `render` that would have no effect are errors, so that a typing mistake or a
// misunderstanding does not pass for an answer.
#pragma once

#include <CLI/CLI.hpp>

#include "options.h"

namespace raysheaf::app {

/// Throws CLI11's error for the first option that has no effect together with the others. Options
/// that depend on the scene are checked when it is loaded.
void check_effect(const CLI::App& app, const RenderCommand& command);

/// The same for settings of methods of which none is in `methods`.
void check_method_settings(const CLI::App& app, const std::vector<Method>& methods);

}  // namespace raysheaf::app
