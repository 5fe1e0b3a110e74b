#include "render/files.h"

#include "raysheaf/animation.h"
#include "raysheaf/error.h"
#include "render/frames.h"

namespace raysheaf::app {
namespace {

void read_pattern(const std::string& pattern, OutputFiles& files) {
  try {
    for (const std::string& name : files_like(pattern)) files.reads(name);
  } catch (const Error&) {  // told where the scene is opened
  }
}

}  // namespace

OutputFiles output_files(const RenderCommand& command) {
  OutputFiles files;
  files.reads_scene(command.scene);
  if (command.scene.find_first_of("*?") != std::string::npos) read_pattern(command.scene, files);
  if (!command.frames.sequence.empty())
    read_pattern(sequence_pattern(command.scene, command.frames.sequence), files);
  files.reads(command.light.environment);
  files.reads(command.frames.camera_path);
  return files;
}

}  // namespace raysheaf::app
