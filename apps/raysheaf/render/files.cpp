#include "render/files.h"

namespace raysheaf::app {

OutputFiles output_files(const RenderCommand& command) {
  OutputFiles files;
  files.reads_scene(command.scene);
  files.reads(command.light.environment);
  files.reads(command.frames.camera_path);
  return files;
}

}  // namespace raysheaf::app
