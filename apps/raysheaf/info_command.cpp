#include "console.h"
#include "info.h"
#include "options.h"
#include "scene_argument.h"

namespace raysheaf::app {

int run(const InfoCommand& command) {
  const SceneDescription scene = scene_from_argument(command.scene, command.load);
  const SceneInfo info = gather_info(scene);
  print(command.json ? info_json(info) : info_text(info));
  return kSuccess;
}

}  // namespace raysheaf::app
