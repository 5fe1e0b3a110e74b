#include <fmt/format.h>

#include "console.h"
#include "options.h"
#include "outputs.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/io.h"
#include "scene_argument.h"

namespace raysheaf::app {

int run(const SceneCommand& command) {
  if (command.list) {
    print(fmt::format("{}\n", fmt::join(builtin_scene_names(), "\n")));
    return kSuccess;
  }
  const std::string target = writable_path(command.output);
  const SceneDescription scene = builtin_from_name(command.name, "scene " + command.name);
  save_glb(scene, target);
  tell(fmt::format("wrote {}: {} triangles in {} meshes", printable(command.output),
                   scene.triangle_count(), scene.instances.size()));
  return kSuccess;
}

}  // namespace raysheaf::app
