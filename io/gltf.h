// From a checked glTF file to a scene. Each function fills its part; indices are glTF's unless
// said.
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

/// The scene and what moves it; instances, cameras and lights are not at their places before `pose`
/// put them there.
struct GltfScene {
  SceneDescription scene;
  Rig rig;
};
[[nodiscard]] GltfScene load_gltf(const Bytes& file, const SceneFile& from);

/// The scene at its places. Warns where clips are left out.
[[nodiscard]] SceneDescription at_rest(GltfScene loaded);

/// The same at rest, in memory that does not grow with the meshes. Nothing of files so small that
/// they may be held. Throws `NeedsWholeFile` where meshes have skins, morph targets or sparse
/// attributes.
[[nodiscard]] std::optional<OuterScene> read_outer_gltf(const std::string& path,
                                                        const PackOptions& options);

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

/// The sets of texture coordinates that a material's textures read: TEXCOORD_n becomes a mesh's
/// first or second set. `second` is -1 where there is one set.
struct UvSets {
  int first = 0, second = -1;
};

/// Fills images, textures and materials. Gives the sets that each material reads.
[[nodiscard]] std::vector<UvSets> read_materials(const GltfModel& model, SceneDescription& scene,
                                                 Warnings& warnings);

/// glTF's nodes and what they show.
struct GltfNodes {
  std::vector<std::uint32_t> place_of;  ///< in the rig, of each node
  /// What each instance of the scene shows: glTF's numbers; `skin` is -1 where there is none.
  struct Use {
    int mesh = -1, skin = -1, node = -1;
  };
  std::vector<Use> uses;
};

/// Fills the rig's nodes, instances without their meshes, lights and cameras. The places that a
/// node shows its mesh at are nodes of the rig below it.
[[nodiscard]] GltfNodes read_nodes(const GltfModel& model, AccessorReader& accessors,
                                   SceneDescription& scene, Rig& rig, Warnings& warnings);

/// Where a node shows its mesh by EXT_mesh_gpu_instancing, relative to itself; empty: once, where
/// it is itself.
[[nodiscard]] std::vector<RigNode> instances_of_node(const JsonValue& node, std::size_t index,
                                                     AccessorReader& accessors);

/// Fills the rig's skins: glTF's, under the same numbers.
void read_skins(const GltfModel& model, const GltfNodes& nodes, AccessorReader& accessors,
                Rig& rig);

/// A mesh as it is read, with what changes its shape.
struct GltfMesh {
  Mesh mesh;
  RigShape shape;  ///< targets, joints and flat triangles
};
/// `joint_count`: of the skin; 0: there is none.
[[nodiscard]] GltfMesh read_mesh(const GltfModel& model, std::size_t index, std::size_t joint_count,
                                 AccessorReader& accessors, const std::vector<UvSets>& uv_sets,
                                 Warnings& warnings);

/// The same, of one without a skin. Throws `NeedsWholeFile`.
void read_outer_mesh(const GltfModel& model, std::size_t index, AccessorReader& accessors,
                     const std::vector<UvSets>& uv_sets, Warnings& warnings,
                     const PackOptions& options, OuterMesh* mesh);

/// Where meshes go that are not to be held.
struct GltfOuter {
  const PackOptions& options;
  OuterColumns& columns;
  std::vector<OuterMesh>& meshes;  ///< beside those of the scene, which have names alone
};

/// Reads the meshes that instances show, one for each shape that they take, leaves out those
/// without triangles, and fills the rig's shapes. Returns the shape of each node, or kInvalidId.
/// `outer`: null where they are held.
[[nodiscard]] std::vector<std::uint32_t> read_meshes(const GltfModel& model, const GltfNodes& nodes,
                                                     const std::vector<UvSets>& uv_sets,
                                                     AccessorReader& accessors,
                                                     const GltfOuter* outer,
                                                     SceneDescription& scene, Rig& rig,
                                                     Warnings& warnings);

/// Fills the rig's clips.
void read_clips(const GltfModel& model, const GltfNodes& nodes,
                const std::vector<std::uint32_t>& shape_of_node, AccessorReader& accessors,
                Rig& rig, Warnings& warnings);

}  // namespace raysheaf::io
