// `raysheaf scene` and `raysheaf pack`, which write scenes, and what `raysheaf render` has for
// those that stream.
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace raysheaf::app {

CLI::App* add_scene(CLI::App& app, SceneCommand& command);
CLI::App* add_pack(CLI::App& app, PackCommand& command);

/// `--stream`, `--memory` and `--share` of `render`.
void add_streaming(CLI::App& app, RenderCommand& command);
/// Throws CLI11's error where other options do not go with streaming.
void check_streaming(const CLI::App& app, const RenderCommand& command);

}  // namespace raysheaf::app
