// What a scene holds, gathered once and told in two ways.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raysheaf/animation.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::app {

/// What can be played, in seconds.
struct ClipInfo {
  std::string name;
  double start = 0, end = 0;
  std::size_t frames = 0;  ///< where they are fixed, as of a sequence of files; else 0
};

struct SceneInfo {
  const SceneDescription* scene = nullptr;
  std::uint64_t triangles = 0;  ///< once an instance
  Box bounds;
  std::vector<std::uint64_t> instances_of_mesh;
  std::vector<ClipInfo> clips;
  std::uint64_t blocks = 0, file_bytes = 0;  ///< of block files; 0 for others
};

/// `scene` must outlive the result.
[[nodiscard]] SceneInfo gather_info(const SceneDescription& scene);
/// Of its scene as it stands, and what can be played; then the last clip is.
[[nodiscard]] SceneInfo gather_info(Animation& animation);

[[nodiscard]] const char* type_name(Light::Type type);
[[nodiscard]] Vec3 position_of(const Camera& camera);

/// Aligned text for people, with a line feed at the end.
[[nodiscard]] std::string info_text(const SceneInfo& info);
/// The JSON that docs/command-line.md describes.
[[nodiscard]] std::string info_json(const SceneInfo& info);

}  // namespace raysheaf::app
