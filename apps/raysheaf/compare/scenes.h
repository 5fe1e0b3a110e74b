// The scenes of the comparison, by name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "raysheaf/scene_description.h"

namespace raysheaf::app {

/// What can be loaded: `name` is short, `source` a file, "builtin:NAME" or "hall:TRIANGLES".
struct CompareScene {
  std::string name, source;
};

/// Those of the folder `scenes` that are there and the generated halls; without a folder, the
/// built-in scenes and the halls. Where the machine has too little memory for the largest hall it
/// is left out, and `notes` takes a sentence. Throws `Error` (kIo) where the folder cannot be read
/// or holds none of them.
[[nodiscard]] std::vector<CompareScene> default_compare_scenes(const std::string& scenes,
                                                               std::vector<std::string>* notes);

/// A name of the above, "builtin:NAME", "hall:TRIANGLES" (1000000, 1m, 300k), or a file. Throws
/// `Error` (kInvalidArgument) for a name without a folder to look in.
[[nodiscard]] CompareScene compare_scene_from_string(const std::string& name,
                                                     const std::string& scenes);

/// Those of an option: by their whole names where two would be called the same.
[[nodiscard]] std::vector<CompareScene> compare_scenes_from_strings(
    const std::vector<std::string>& names, const std::string& scenes);

/// With a camera that stands inside where the file has none and the scene is known.
[[nodiscard]] SceneDescription load_compare_scene(const CompareScene& scene, std::uint32_t threads);

}  // namespace raysheaf::app
