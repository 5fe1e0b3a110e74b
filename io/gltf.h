// From glTF's structs to a scene. Each function fills its part; indices are glTF's unless said.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "io/gltf_model.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

[[nodiscard]] SceneDescription load_gltf(const Bytes& file, const SceneFile& from);

/// Sentences about what is left out, each kind once.
class Warnings {
 public:
  void once(const std::string& sentence) {
    if (seen_.insert(sentence).second) sentences_.push_back(sentence);
  }
  [[nodiscard]] std::vector<std::string> take() { return std::move(sentences_); }

 private:
  std::set<std::string> seen_;
  std::vector<std::string> sentences_;
};

/// Fills images, textures and materials. Gives the set of texture coordinates that each material
/// reads.
[[nodiscard]] std::vector<int> read_materials(const GltfModel& gltf, SceneDescription& scene,
                                              Warnings& warnings);

/// Fills instances, lights and cameras. The instances' meshes are still glTF's.
void read_nodes(const tinygltf::Model& model, SceneDescription& scene, Warnings& warnings);

/// Reads the meshes that instances name, leaves out those without triangles, and turns the
/// instances' meshes into the scene's.
void read_meshes(const GltfModel& gltf, const std::vector<int>& uv_sets, SceneDescription& scene,
                 Warnings& warnings);

}  // namespace raysheaf::io
