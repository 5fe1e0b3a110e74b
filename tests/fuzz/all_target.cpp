#include "fuzz/targets.h"

namespace raysheaf::fuzz {

std::span<const Target> targets() {
  static constexpr Target kAll[] = {
      {"gltf", run_gltf}, {"draco", run_draco},   {"obj", run_obj},         {"mtl", run_mtl},
      {"ply", run_ply},   {"stl", run_stl},       {"image", run_image},     {"exr", run_exr},
      {"hdr", run_hdr},   {"blocks", run_blocks}, {"options", run_options}, {"query", run_query}};
  return kAll;
}

}  // namespace raysheaf::fuzz
