// raysheaf-view: `raysheaf view`.
#include "apps/support/console.h"
#include "apps/support/output_files.h"
#include "entry/entry.h"
#include "options.h"
#include "render/frames.h"
#include "view.h"

namespace raysheaf::app {

std::vector<const char*> command_line(int argc, const char* const* argv) {
  std::vector<const char*> line = {"raysheaf", "view"};
  if (argc > 1) line.insert(line.end(), argv + 1, argv + argc);
  return line;
}

int run(const ViewCommand& command) {
  viewer::ViewOptions options;
  options.scene = command.scene;
  options.script = command.script_path;
  OutputFiles files;
  if (!command.scene.empty()) files.reads_scene(command.scene);
  files.reads(command.script_path);
  options.screenshot = files.open(command.screenshot_path);
  files.claim(command.settings_path);
  options.settings = command.settings_path;
  options.width = command.width;
  options.height = command.height;
  options.threads = command.threads;
  options.view = command.view;
  options.up = command.up;
  options.orthographic = command.orthographic;
  options.load = [load = command.load, files](const std::string& scene) mutable {
    std::unique_ptr<Animation> animation = animation_from_argument(scene, {}, load);
    files.reads(animation->scene().files);
    return animation;
  };
  options.print = [](const std::string& text) { print(text); };
  options.tell = [](const std::string& line) { tell("raysheaf: " + printable(line)); };
  viewer::view(options);
  return kSuccess;
}

}  // namespace raysheaf::app
