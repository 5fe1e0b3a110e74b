// Writes a scene as the JSON and the binary chunk of a GLB file.
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

/// The parts of a GLB file under construction.
struct GlbParts {
  std::map<std::string, std::vector<Json>> lists;  ///< the arrays of the JSON's root object
  Bytes binary;
  std::vector<Json> lights;          ///< the lights of KHR_lights_punctual
  std::set<std::string> extensions;  ///< extensions that the file uses

  /// Appends bytes at a multiple of four and returns the index of their buffer view. `target` is
  /// the view's OpenGL target; 0 for data other than vertices and indices.
  std::size_t add_view(std::span<const std::uint8_t> bytes, int target = 0);
  /// Appends an item to one of the root's arrays and returns its index.
  std::size_t add(const char* list, const Json& item);
  /// Returns the index of an equal item, and appends the item if there is none.
  std::size_t find_or_add(const char* list, const Json& item);
};

void write_materials(const SceneDescription& scene, GlbParts& parts);  ///< also textures and images
void write_meshes(const SceneDescription& scene, GlbParts& parts);
void write_nodes(const SceneDescription& scene, GlbParts& parts);  ///< also lights and cameras

/// The power of two that makes `value` divided by it at most 1, without rounding: for fields whose
/// factors must not exceed 1.
[[nodiscard]] float power_of_two_above(Vec3 value);

}  // namespace raysheaf::io
