// `raysheaf scene` and `raysheaf pack`, which write scenes, and the options of `raysheaf render`
// for streaming.
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
/// Throws CLI11's error if other options contradict streaming.
void check_streaming(const CLI::App& app, const RenderCommand& command);

}  // namespace raysheaf::app
