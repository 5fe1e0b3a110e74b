#include "io/gltf.h"

#include "io/gltf_rules.h"
#include "raysheaf/animation.h"

namespace raysheaf::io {
namespace {

/// Limits of the bytes that accessors may expand to: per byte of the file, and in addition. Scenes
/// with many small meshes of individual shape stay below them, and a file of a kilobyte cannot
/// allocate gigabytes.
constexpr std::size_t kBytesPerByte = 256, kFreeBytes = std::size_t{1} << 27;

/// Files with at most this many bytes per `triangles_at_once`, buffers included, may be read whole.
constexpr std::uint64_t kSmallGltfBytes = 16;

GltfScene read_gltf(const GltfModel& model, const SceneFile& from, const GltfOuter* outer) {
  GltfScene result;
  SceneDescription& scene = result.scene;
  scene.name = stem_of(from.path);
  Warnings warnings;
  for (const std::string& sentence : model.warnings) warnings.once(sentence);
  AccessorReader accessors(model, kFreeBytes + kBytesPerByte * model.file_bytes);
  const GltfNodes nodes = read_nodes(model, accessors, scene, result.rig, warnings);
  const std::vector<UvSets> uv_sets = read_materials(model, scene, warnings);
  read_skins(model, nodes, accessors, result.rig);
  const std::vector<std::uint32_t> shape_of_node =
      read_meshes(model, nodes, uv_sets, accessors, outer, scene, result.rig, warnings);
  read_clips(model, nodes, shape_of_node, accessors, result.rig, warnings);
  scene.warnings = warnings.take();
  return result;
}

/// `parse_gltf`, with a warning for URIs that are Windows paths.
GltfModel parse_any(const GltfBytes& file, SceneFile from) {
  std::set<std::string> turned;
  from.turned = &turned;
  GltfModel model = parse_gltf(file, from);
  for (const std::string& uri : turned)
    model.warnings.push_back("\"" + printable(uri) +
                             "\" is not a valid URI: \"\\\" in it is read as \"/\".");
  return model;
}

}  // namespace

GltfScene load_gltf(const Bytes& file, const SceneFile& from) {
  return read_gltf(parse_any(GltfBytes(file), from), from, nullptr);
}

SceneDescription at_rest(GltfScene loaded) {
  if (!loaded.rig.nodes.empty()) pose(loaded.rig, loaded.scene);
  if (!loaded.rig.clips.empty())
    loaded.scene.warnings.emplace_back("Animations are left out: the scene is shown at rest.");
  return std::move(loaded.scene);
}

std::optional<OuterScene> read_outer_gltf(const std::string& path, const PackOptions& options) {
  const GltfFile file(path, "");
  std::set<std::string> names;
  const SceneFile from{path, options.allow_external, nullptr, &names};
  const GltfModel model = parse_any(GltfBytes(file), from);
  if (model.file_bytes <= kSmallGltfBytes * options.triangles_at_once) return std::nullopt;
  OuterScene scene;
  scene.columns = std::make_unique<OuterColumns>(options);
  const GltfOuter outer{options, *scene.columns, scene.meshes};
  scene.rest = at_rest(read_gltf(model, from, &outer));
  scene.rest.files = files_of(from);
  return scene;
}

}  // namespace raysheaf::io
