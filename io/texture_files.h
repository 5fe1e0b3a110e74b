// The image files that OBJ and PLY materials refer to, and their textures.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "io/file.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

class TextureFiles {
 public:
  TextureFiles(const SceneFile& from, SceneDescription& scene) : from_(from), scene_(scene) {}

  struct Use {
    bool clamped = false;  ///< otherwise the texture repeats
    bool is_data = false;  ///< numbers rather than colours
  };
  /// Index of the texture for the image `name` (see `find_named`). Adds a warning and returns
  /// `kInvalidId` if the name leads outside the scene's folder.
  std::uint32_t add(const std::string& name, Use use, const std::string& named_in,
                    const std::string& place);

  /// Decodes the images into the scene. Removes textures whose image cannot be read, with a
  /// warning. Returns the new index of each texture, or `kInvalidId`. Call it once.
  [[nodiscard]] std::vector<std::uint32_t> finish();

 private:
  /// The path, and whether it is read as data.
  using Key = std::string;
  std::map<Key, std::uint32_t> read_images();
  void warn_once(const std::string& sentence);

  const SceneFile& from_;
  SceneDescription& scene_;
  std::map<std::string, std::uint32_t> texture_of_;
  struct Shown {
    std::string path;
    bool is_data;
    [[nodiscard]] Key key() const { return path + (is_data ? std::string("\n") : std::string()); }
  };
  std::vector<Shown> shown_;  ///< one per texture
  std::set<std::string> warned_;
};

}  // namespace raysheaf::io
