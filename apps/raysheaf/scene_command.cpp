#include <fmt/ranges.h>

#include "apps/support/console.h"
#include "apps/support/output_files.h"
#include "apps/support/scene_argument.h"
#include "apps/support/stoppable_sink.h"
#include "apps/support/table.h"
#include "options.h"
#include "raysheaf/builtin_scenes.h"
#include "raysheaf/io.h"
#include "render/stream.h"

namespace raysheaf::app {
namespace {

bool is_hall(const SceneCommand& command) {
  return command.name == "hall";
}

SceneDescription scene_of(const SceneCommand& command) {
  if (is_hall(command)) return hall_scene(command.triangles, command.threads);
  return builtin_from_name(command.name, "scene " + command.name);
}

/// "792 triangles, 7 meshes, 7 instances".
std::string contents(std::uint64_t triangles, const SceneDescription& scene) {
  return fmt::format("{}, {}, {}", count_text(triangles, "triangle", "triangles"),
                     count_text(scene.meshes.size(), "mesh", "meshes"),
                     count_text(scene.instances.size(), "instance", "instances"));
}

/// Returns a summary of the file.
std::string write_glb(const SceneCommand& command, const std::string& target) {
  const SceneDescription scene = scene_of(command);
  stop_if_interrupted();
  save_glb(scene, target);
  stop_if_interrupted();  // the file is complete by then
  return contents(scene.triangle_count(), scene);
}

/// Returns a summary of the file.
std::string write_blocks(const SceneCommand& command, const std::string& target) {
  BlockFileWriter file(target, {command.compress});
  StoppableSink sink(&file);
  const SceneDescription rest = is_hall(command)
                                    ? hall_in_blocks(command.triangles, &sink, command.threads)
                                    : cut_into_blocks(scene_of(command), &sink);
  stop_if_interrupted();
  file.finish(rest);
  return contents(file.triangle_count(), rest);
}

}  // namespace

int run(const SceneCommand& command) {
  if (command.list) {
    print(fmt::format("{}\n", fmt::join(builtin_scene_names(), "\n")));
    return kSuccess;
  }
  catch_interrupts();
  const std::string target = writable_path(command.output);
  const std::string written =
      is_block_file(command.output) ? write_blocks(command, target) : write_glb(command, target);
  tell(fmt::format("wrote {}: {}", printable(command.output), written));
  return kSuccess;
}

}  // namespace raysheaf::app
