// Reads the meshes that nodes show, once for each shape that they take.
#include <map>
#include <tuple>

#include "io/gltf.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

/// Limits of the triangles of all instances: per byte of the file, and in addition.
constexpr std::uint64_t kTrianglesPerByte = 256, kFreeTriangles = std::uint64_t{1} << 22;

/// Whether an animation drives the morph weights of each node's mesh.
std::vector<bool> driven_weights(const GltfModel& model) {
  std::vector<bool> driven(model.list("nodes").size(), false);
  for (const JsonValue& animation : model.list("animations")) {
    for (const JsonValue& channel : animation.items("channels")) {
      // Animations are validated later, and invalid ones are ignored.
      const JsonValue* const target = channel.find("target");
      const JsonValue* const path = target == nullptr ? nullptr : target->find("path");
      const JsonValue* const node = target == nullptr ? nullptr : target->find("node");
      if (path == nullptr || !path->is_string() || node == nullptr || !node->is_integer()) continue;
      const double number = node->get<double>();
      if (path->get<std::string_view>() == "weights" && number >= 0 &&
          number < static_cast<double>(driven.size()))
        driven[node->get<std::size_t>()] = true;
    }
  }
  return driven;
}

/// The node's weights; if it has none, the mesh's; otherwise zeros.
std::vector<float> rest_weights(const GltfModel& model, const GltfNodes::Use& use,
                                std::size_t target_count) {
  const auto node = static_cast<std::size_t>(use.node), mesh = static_cast<std::size_t>(use.mesh);
  const auto of_the_node = model.list("nodes")[node].items("weights");
  const bool of_node = !of_the_node.empty();
  const auto said = of_node ? of_the_node : model.list("meshes")[mesh].items("weights");
  if (!said.empty() && said.size() != target_count) {
    throw Error(ErrorCode::kInvalidData,
                "has " + std::to_string(said.size()) + " weights, but the mesh has " +
                    std::to_string(target_count) + " morph targets",
                (of_node ? "nodes[" + std::to_string(node) : "meshes[" + std::to_string(mesh)) +
                    "].weights");
  }
  std::vector<float> weights(target_count, 0.0f);
  for (std::size_t i = 0; i < said.size(); ++i) weights[i] = said[i].get<float>();
  return weights;
}

/// Returns whether the mesh has triangles. `mesh` gets its name.
bool add_outer(const GltfModel& model, std::size_t number, AccessorReader& accessors,
               const std::vector<UvSets>& uv_sets, Warnings& warnings, const GltfOuter& outer,
               Mesh* mesh) {
  OuterMesh read(&outer.columns);
  read_outer_mesh(model, number, accessors, uv_sets, warnings, outer.options, &read);
  mesh->name = read.name;
  if (read.triangles.empty()) return false;
  outer.meshes.push_back(std::move(read));
  return true;
}

std::uint64_t shown_triangles(const SceneDescription& scene, const GltfOuter* outer) {
  if (outer == nullptr) return scene.triangle_count();
  std::uint64_t count = 0;
  for (const Instance& instance : scene.instances)
    count += outer->meshes[instance.mesh].triangles.size();
  return count;
}

}  // namespace

std::vector<std::uint32_t> read_meshes(const GltfModel& model, const GltfNodes& nodes,
                                       const std::vector<UvSets>& uv_sets,
                                       AccessorReader& accessors, const GltfOuter* outer,
                                       SceneDescription& scene, Rig& rig, Warnings& warnings) {
  const auto all_nodes = model.list("nodes");
  const std::vector<bool> driven = driven_weights(model);
  // Instances share a mesh if they agree in glTF's mesh and skin, and, for nodes with weights of
  // their own, in the node.
  using Key = std::tuple<int, int, int>;
  std::map<Key, std::uint32_t> index_of;
  const auto key_of = [&](const GltfNodes::Use& use) {
    const auto n = static_cast<std::size_t>(use.node);
    const bool alone = driven[n] || !all_nodes[n].items("weights").empty();
    return Key{use.mesh, use.skin, alone ? use.node : -1};
  };
  std::map<Key, GltfNodes::Use> wanted;
  for (const GltfNodes::Use& use : nodes.uses) {
    if (outer != nullptr && use.skin >= 0) throw NeedsWholeFile{};
    wanted.emplace(key_of(use), use);
  }
  std::vector<std::uint32_t> shape_of_node(all_nodes.size(), kInvalidId);
  for (const auto& [key, use] : wanted) {
    const std::size_t joints =
        use.skin < 0 ? 0 : rig.skins[static_cast<std::size_t>(use.skin)].joints.size();
    index_of[key] = kInvalidId;
    const auto number = static_cast<std::size_t>(use.mesh);
    GltfMesh read;
    if (outer == nullptr) {
      read = read_mesh(model, number, joints, accessors, uv_sets, warnings);
      if (read.mesh.triangles.empty()) continue;
    } else if (!add_outer(model, number, accessors, uv_sets, warnings, *outer, &read.mesh)) {
      continue;
    }
    index_of[key] = static_cast<std::uint32_t>(scene.meshes.size());
    scene.meshes.push_back(std::move(read.mesh));
    if (joints == 0 && read.shape.targets.empty()) continue;
    read.shape.mesh = index_of[key];
    read.shape.weights = rest_weights(model, use, read.shape.targets.size());
    if (use.skin >= 0) read.shape.skin = static_cast<std::uint32_t>(use.skin);
    shape_of_node[static_cast<std::size_t>(use.node)] =
        static_cast<std::uint32_t>(rig.shapes.size());
    rig.shapes.push_back(std::move(read.shape));
  }
  std::vector<Instance> shown;
  std::vector<std::uint32_t> shown_nodes;
  for (std::size_t i = 0; i < nodes.uses.size(); ++i) {
    const std::uint32_t mesh = index_of[key_of(nodes.uses[i])];
    if (mesh == kInvalidId) continue;
    shown.push_back(std::move(scene.instances[i]));
    shown.back().mesh = mesh;
    shown_nodes.push_back(rig.instance_nodes[i]);
  }
  scene.instances = std::move(shown);
  rig.instance_nodes = std::move(shown_nodes);
  if (shown_triangles(scene, outer) > kFreeTriangles + kTrianglesPerByte * model.file_bytes)
    throw Error(ErrorCode::kOutOfMemory,
                "the instances have far more triangles than the file has bytes", "nodes");
  return shape_of_node;
}

}  // namespace raysheaf::io
