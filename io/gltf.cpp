#include "io/gltf.h"

#include <filesystem>

namespace raysheaf::io {
namespace {

/// Elements that may be read for each byte of the file, and besides.
constexpr std::size_t kElementsPerByte = 16, kFreeElements = std::size_t{1} << 18;

}  // namespace

GltfScene load_gltf(const Bytes& file, const SceneFile& from) {
  const GltfModel model = parse_gltf(file, from);
  GltfScene result;
  SceneDescription& scene = result.scene;
  scene.name = std::filesystem::path(from.path).stem().string();
  Warnings warnings;
  for (const std::string& sentence : model.warnings) warnings.once(sentence);
  const GltfNodes nodes = read_nodes(model, scene, result.rig);
  const std::vector<int> uv_sets = read_materials(model, scene, warnings);
  AccessorReader accessors(model, kFreeElements + kElementsPerByte * model.file_bytes);
  read_skins(model, nodes, accessors, result.rig);
  const std::vector<std::uint32_t> shape_of_node =
      read_meshes(model, nodes, uv_sets, accessors, scene, result.rig, warnings);
  read_clips(model, nodes, shape_of_node, accessors, result.rig, warnings);
  scene.warnings = warnings.take();
  return result;
}

}  // namespace raysheaf::io
