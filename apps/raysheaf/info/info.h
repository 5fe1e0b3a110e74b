// The contents of a scene, gathered once and printed as text or as JSON.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raysheaf/animation.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::app {

/// An animation; times are in seconds.
struct ClipInfo {
  std::string name;
  double start = 0, end = 0;
  std::size_t frames = 0;  ///< of a sequence of files; 0 for all other animations
};

struct SceneInfo {
  const SceneDescription* scene = nullptr;
  std::string kind;             ///< "OBJ file", "built-in scene"
  bool in_metres = false;       ///< the format defines its unit; other units are not known
  std::uint64_t triangles = 0;  ///< counted once per instance
  std::uint64_t geometry_bytes = 0, image_bytes = 0;  ///< of the arrays in memory
  Box bounds;
  std::vector<std::uint64_t> instances_of_mesh;
  std::vector<ClipInfo> clips;
  std::uint64_t blocks = 0, file_bytes = 0;  ///< of block files only
};

/// `argument` is SCENE on the command line. `scene` must outlive the result.
[[nodiscard]] SceneInfo gather_info(const SceneDescription& scene,
                                    const std::string& argument = "");
/// Gathers the scene at rest, with its animations; afterwards the last animation is selected.
[[nodiscard]] SceneInfo gather_info(Animation& animation, const std::string& argument);

[[nodiscard]] const char* type_name(Light::Type type);
[[nodiscard]] Vec3 position_of(const Camera& camera);

/// About ten aligned lines, each with a line feed at its end.
[[nodiscard]] std::string info_summary(const SceneInfo& info);
/// Tables of all meshes, materials, lights, cameras, animations and images, and all warnings.
[[nodiscard]] std::string info_details(const SceneInfo& info);
/// The JSON that docs/command-line.md describes.
[[nodiscard]] std::string info_json(const SceneInfo& info);

}  // namespace raysheaf::app
