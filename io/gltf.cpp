#include "io/gltf.h"

#include <filesystem>

namespace raysheaf::io {
namespace {

/// Elements that may be read for each byte of the file, and besides.
constexpr std::size_t kElementsPerByte = 16, kFreeElements = std::size_t{1} << 18;

}  // namespace

GltfScene load_gltf(const Bytes& file, const SceneFile& from) {
  const GltfModel gltf = parse_gltf(file, from);
  GltfScene result;
  SceneDescription& scene = result.scene;
  scene.name = std::filesystem::path(from.path).stem().string();
  Warnings warnings;
  for (const std::string& sentence : gltf.warnings) warnings.once(sentence);
  const GltfNodes nodes = read_nodes(gltf.model, scene, result.rig);
  const std::vector<int> uv_sets = read_materials(gltf, scene, warnings);
  AccessorReader accessors(gltf.model, kFreeElements + kElementsPerByte * gltf.file_bytes);
  read_skins(gltf.model, nodes, accessors, result.rig);
  const std::vector<std::uint32_t> shape_of_node =
      read_meshes(gltf, nodes, uv_sets, accessors, scene, result.rig, warnings);
  read_clips(gltf.model, nodes, shape_of_node, accessors, result.rig, warnings);
  scene.warnings = warnings.take();
  return result;
}

}  // namespace raysheaf::io
