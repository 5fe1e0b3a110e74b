// A scene as the JSON and the bytes of a GLB.
#pragma once

#include <cstring>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "io/file.h"
#include "io/json_writer.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// What a GLB is made of, while it grows.
struct GlbParts {
  std::map<std::string, std::vector<Json>> lists;  ///< the root's arrays
  Bytes binary;
  std::vector<Json> lights;          ///< those of KHR_lights_punctual
  std::set<std::string> extensions;  ///< that are used

  /// Appends bytes on a boundary of four and gives the index of their buffer view. `target`: what
  /// OpenGL shall take them for; 0 where it is neither vertices nor indices.
  std::size_t add_view(std::span<const std::uint8_t> bytes, int target = 0);
  /// Appends an item to one of the root's arrays and gives its index.
  std::size_t add(const char* list, const Json& item);
  /// The index of an equal one, which is appended unless there is one.
  std::size_t find_or_add(const char* list, const Json& item);
};

void write_materials(const SceneDescription& scene, GlbParts& parts);  ///< and textures, images
void write_meshes(const SceneDescription& scene, GlbParts& parts);
void write_nodes(const SceneDescription& scene, GlbParts& parts);  ///< and lights, cameras

/// `value` as a power of two and a rest of at most 1 whose product it is exactly: for fields whose
/// factors may not exceed 1.
[[nodiscard]] float power_of_two_above(Vec3 value);

}  // namespace raysheaf::io
