#include <algorithm>
#include <memory>

#include "apps/support/console.h"
#include "info/info.h"
#include "options.h"
#include "raysheaf/block_file.h"
#include "render/frames.h"
#include "render/stream.h"
#include "scene_input.h"

namespace raysheaf::app {

namespace {

/// From the header of a block file; no block is read.
SceneInfo info_of_blocks(const BlockFile& file, const std::string& argument) {
  SceneInfo info = gather_info(file.scene(), argument);
  info.triangles = file.triangle_count();
  info.blocks = file.blocks().size();
  info.file_bytes = file.file_bytes();
  for (const BlockInfo& block : file.blocks()) {
    const Vec3 lo = block.bounds.min, hi = block.bounds.max;
    Box& all = info.bounds;
    all.min = {std::min(all.min.x, lo.x), std::min(all.min.y, lo.y), std::min(all.min.z, lo.z)};
    all.max = {std::max(all.max.x, hi.x), std::max(all.max.y, hi.y), std::max(all.max.z, hi.z)};
  }
  return info;
}

void print_info(const SceneInfo& info, const InfoCommand& command) {
  if (command.json) return print(info_json(info));
  print(info_summary(info) + (command.all ? info_details(info) : ""));
}

void print_info(const InfoCommand& command) {
  if (is_block_file(command.scene)) {
    const BlockFile file(command.scene);
    return print_info(info_of_blocks(file, command.scene), command);
  }
  const std::unique_ptr<Animation> animation =
      animation_from_argument(command.scene, {}, command.load);
  print_info(gather_info(*animation, command.scene), command);
}

}  // namespace

int run(const InfoCommand& given) {
  InfoCommand command = given;
  const SceneInput input(&command.scene);
  input.naming([&] { print_info(command); });
  return kSuccess;
}

}  // namespace raysheaf::app
