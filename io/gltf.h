// Converts a validated glTF file to a scene, one function per part. Indices are those of the glTF
// file unless stated otherwise.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "io/gltf_accessor.h"
#include "io/gltf_model.h"
#include "io/outer_mesh.h"
#include "raysheaf/rig.h"

namespace raysheaf::io {

/// A scene and its animation. Instances, cameras and lights have no valid positions until `pose`
/// has set them.
struct GltfScene {
  SceneDescription scene;
  Rig rig;
};
[[nodiscard]] GltfScene load_gltf(const Bytes& file, const SceneFile& from);

/// The scene in its rest pose. Warns if animations are ignored.
[[nodiscard]] SceneDescription at_rest(GltfScene loaded);

/// The scene in its rest pose, read with memory that does not grow with the meshes. Nothing if the
/// file is small enough to be read whole. Throws `NeedsWholeFile` if meshes have skins, morph
/// targets or sparse attributes.
[[nodiscard]] std::optional<OuterScene> read_outer_gltf(const std::string& path,
                                                        const PackOptions& options);

/// Collects warnings about ignored features, each sentence once.
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

/// The texture coordinate sets that a material's textures use: TEXCOORD_n becomes a mesh's first or
/// second set. `second` is -1 if there is only one.
struct UvSets {
  int first = 0, second = -1;
};

/// Fills images, textures and materials. Returns the sets that each material uses.
[[nodiscard]] std::vector<UvSets> read_materials(const GltfModel& model, SceneDescription& scene,
                                                 Warnings& warnings);

/// The glTF nodes and the meshes that they show.
struct GltfNodes {
  std::vector<std::uint32_t> place_of;  ///< the rig's node for each glTF node
  /// The glTF indices behind each instance of the scene. `skin` is -1 for a mesh without a skin.
  struct Use {
    int mesh = -1, skin = -1, node = -1;
  };
  std::vector<Use> uses;
};

/// Fills the rig's nodes, instances (without meshes), lights and cameras. Each place at which
/// EXT_mesh_gpu_instancing shows a node's mesh becomes a child node in the rig.
[[nodiscard]] GltfNodes read_nodes(const GltfModel& model, AccessorReader& accessors,
                                   SceneDescription& scene, Rig& rig, Warnings& warnings);

/// The places of EXT_mesh_gpu_instancing, relative to the node. If empty, the node shows its mesh
/// once, at its own place.
[[nodiscard]] std::vector<RigNode> instances_of_node(const JsonValue& node, std::size_t index,
                                                     AccessorReader& accessors);

/// Fills the rig's skins, in glTF's order.
void read_skins(const GltfModel& model, const GltfNodes& nodes, AccessorReader& accessors,
                Rig& rig);

/// A mesh, and the data that deforms it.
struct GltfMesh {
  Mesh mesh;
  RigShape shape;  ///< morph targets, joints and flat-shaded triangles
};
/// `joint_count` is that of the skin; 0: the mesh has no skin.
[[nodiscard]] GltfMesh read_mesh(const GltfModel& model, std::size_t index, std::size_t joint_count,
                                 AccessorReader& accessors, const std::vector<UvSets>& uv_sets,
                                 Warnings& warnings);

/// Reads a mesh without a skin into files. Throws `NeedsWholeFile`.
void read_outer_mesh(const GltfModel& model, std::size_t index, AccessorReader& accessors,
                     const std::vector<UvSets>& uv_sets, Warnings& warnings,
                     const PackOptions& options, OuterMesh* mesh);

/// Where to store meshes that are not kept in memory.
struct GltfOuter {
  const PackOptions& options;
  OuterColumns& columns;
  std::vector<OuterMesh>& meshes;  ///< match the scene's meshes, which only have names
};

/// Reads the meshes that instances show, once per combination of mesh and shape. Skips meshes
/// without triangles and fills the rig's shapes. Returns the shape of each node, or kInvalidId.
/// `outer` is null if the meshes are kept in memory.
[[nodiscard]] std::vector<std::uint32_t> read_meshes(const GltfModel& model, const GltfNodes& nodes,
                                                     const std::vector<UvSets>& uv_sets,
                                                     AccessorReader& accessors,
                                                     const GltfOuter* outer,
                                                     SceneDescription& scene, Rig& rig,
                                                     Warnings& warnings);

/// Fills the rig's animation clips.
void read_clips(const GltfModel& model, const GltfNodes& nodes,
                const std::vector<std::uint32_t>& shape_of_node, AccessorReader& accessors,
                Rig& rig, Warnings& warnings);

}  // namespace raysheaf::io
