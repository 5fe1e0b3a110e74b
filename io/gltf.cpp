#include "io/gltf.h"

#include <filesystem>

namespace raysheaf::io {

SceneDescription load_gltf(const Bytes& file, const SceneFile& from) {
  const GltfModel gltf = parse_gltf(file, from);
  SceneDescription scene;
  scene.name = std::filesystem::path(from.path).stem().string();
  Warnings warnings;
  for (const std::string& sentence : gltf.warnings) warnings.once(sentence);
  if (!gltf.model.animations.empty()) warnings.once("Animations are left out.");
  read_nodes(gltf.model, scene, warnings);
  const std::vector<int> uv_sets = read_materials(gltf, scene, warnings);
  read_meshes(gltf, uv_sets, scene, warnings);
  scene.warnings = warnings.take();
  return scene;
}

}  // namespace raysheaf::io
