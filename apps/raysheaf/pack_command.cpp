#include <fmt/format.h>

#include "apps/support/console.h"
#include "apps/support/output_files.h"
#include "apps/support/scene_argument.h"
#include "apps/support/stoppable_sink.h"
#include "apps/support/table.h"
#include "options.h"
#include "raysheaf/block_file.h"
#include "raysheaf/error.h"
#include "render/stream.h"

namespace raysheaf::app {
namespace {

/// Copies the blocks of a block file unchanged.
void copy_blocks(const BlockFile& from, BlockSink* to) {
  TriangleBlock block;
  BlockShading shading;
  for (std::size_t i = 0; i < from.blocks().size(); ++i) {
    from.read(i, &block);
    from.read_shading(i, &shading);
    to->add(block, shading);
  }
}

void tell_warnings(const PackCommand& command, const SceneDescription& scene) {
  if (command.quiet) return;
  for (const std::string& warning : scene.warnings) tell("warning: " + printable(warning));
}

/// Returns the scene without its triangles, which go to the sink.
SceneDescription pack(const PackCommand& command, BlockSink* sink) {
  if (is_block_file(command.scene)) {
    const BlockFile from(command.scene);
    copy_blocks(from, sink);
    return from.scene();
  }
  if (auto rest = pack_file(command.scene, sink,
                            {.triangles_a_block = command.block_triangles,
                             .beside = command.output,
                             .allow_external = command.load.allow_external})) {
    tell_warnings(command, *rest);
    return std::move(*rest);
  }
  const SceneDescription scene = scene_from_argument(command.scene, command.load);
  stop_if_interrupted();
  SceneDescription rest = cut_into_blocks(scene, sink, command.block_triangles);
  tell_warnings(command, rest);
  return rest;
}

}  // namespace

int run(const PackCommand& command) {
  catch_interrupts();
  BlockFileWriter file(writable_path(command.output), command.file);
  StoppableSink sink(&file);
  const SceneDescription rest = pack(command, &sink);
  stop_if_interrupted();
  file.finish(rest);
  if (!command.quiet)
    tell(fmt::format("wrote {}: {} in {}, {:.1f} MB", printable(command.output),
                     count_text(file.triangle_count(), "triangle", "triangles"),
                     count_text(file.block_count(), "block", "blocks"),
                     static_cast<double>(file.written_bytes()) * 1e-6));
  return kSuccess;
}

}  // namespace raysheaf::app
