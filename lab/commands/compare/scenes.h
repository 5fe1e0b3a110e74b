// The scenes of the comparison, by name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf::app {

/// A scene that can be loaded: `name` is short, `source` is a file, "builtin:NAME" or
/// "hall:TRIANGLES".
struct CompareScene {
  std::string name, source;
};

/// The known scenes that the folder `scenes` contains, and the generated halls; without a folder,
/// the built-in scenes and the halls. If the memory of the machine is too small for the largest
/// hall, that is omitted, and `notes` gets a sentence about it. Throws `Error` (kIo) if the folder
/// cannot be read or contains none of the scenes.
[[nodiscard]] std::vector<CompareScene> default_compare_scenes(const std::string& scenes,
                                                               std::vector<std::string>* notes);

/// A name from above, "builtin:NAME", "hall:TRIANGLES" (1000000, 1m, 300k), or a file. Throws
/// `Error` (kInvalidArgument) for a name without a folder to search.
[[nodiscard]] CompareScene compare_scene_from_string(const std::string& name,
                                                     const std::string& scenes);

/// The scenes of an option, with their full names if two short names would be equal.
[[nodiscard]] std::vector<CompareScene> compare_scenes_from_strings(
    const std::vector<std::string>& names, const std::string& scenes);

/// The scenes that `names` name; without names, `default_compare_scenes`.
[[nodiscard]] std::vector<CompareScene> chosen_compare_scenes(const std::vector<std::string>& names,
                                                              const std::string& scenes,
                                                              std::vector<std::string>* notes);

/// Adds a camera inside the scene if the file has none and the scene is known.
[[nodiscard]] SceneDescription load_compare_scene(const CompareScene& scene, std::uint32_t threads);

}  // namespace raysheaf::app
