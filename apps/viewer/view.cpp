#include "view.h"

#include <algorithm>

#include "raysheaf/error.h"
#include "settings_file.h"
#include "shell.h"

namespace raysheaf::viewer {
namespace {

/// The script for runs with only a screenshot.
constexpr const char* kScreenshotScript = "wait-for-refined\n";

ViewSettings remembered(const ViewOptions& options, const std::string& path) {
  LoadedSettings loaded = load_settings(path);
  if (!loaded.sentence.empty()) options.tell(loaded.sentence);
  if (options.threads != 0) loaded.settings.threads = options.threads;
  if (options.up) loaded.settings.up = *options.up;
  if (options.width != 0) {
    loaded.settings.width = options.width;
    loaded.settings.height = options.height;
  }
  return loaded.settings;
}

/// Only a sentence: the viewer has finished its task.
void remember(const ViewOptions& options, const ViewSettings& settings, const std::string& path) {
  if (path.empty()) return;
  try {
    save_settings(settings, path);
  } catch (const Error& error) {
    options.tell(std::string("settings are not saved: ") + error.what());
  }
}

std::optional<Script> script_of(const ViewOptions& options) {
  std::optional<Script> script;
  if (!options.script.empty()) {
    script = load_script(options.script);
  } else if (!options.screenshot.empty()) {
    script = parse_script(kScreenshotScript, "--screenshot");
  }
  if (script && !options.screenshot.empty()) {
    std::vector<ScriptCommand>& commands = script->commands;
    const auto end = std::find_if(commands.begin(), commands.end(),
                                  [](const ScriptCommand& c) { return c.words[0] == "quit"; });
    commands.insert(end, {0, {"screenshot", options.screenshot}});
  }
  return script;
}

/// The scene of the command line must load; the failure of a later one is only a note.
void check_first_scene(const ViewOptions& options, const Model& model) {
  if (!options.scene.empty() && !model.loading() && !model.facts())
    throw Error(ErrorCode::kInvalidData, model.last_note().text);
}

}  // namespace

void view(const ViewOptions& options) {
  std::optional<Script> script = script_of(options);
  const std::string settings_path =
      options.settings.empty() && !script ? default_settings_path() : options.settings;
  const ViewSettings settings = remembered(options, settings_path);
  Window window({settings.width, settings.height, script.has_value()});
  Tracer tracer({options.load, Window::wake});
  Model model(settings, tracer);
  Shell shell(window, model, script.has_value());
  shell.print_to = options.print;
  std::optional<ScriptPlayer> player;
  if (script) player.emplace(*std::move(script), model, shell);
  if (!options.scene.empty()) {
    model.begin_from(options.view, options.orthographic);
    model.load(options.scene);
  }
  while (!window.closing() && !model.quit()) {
    shell.turn(player ? &*player : nullptr);
    check_first_scene(options, model);
    if (player && player->done()) break;
  }
  remember(options, model.settings, settings_path);
}

}  // namespace raysheaf::viewer
