// The image files that the materials of OBJ and PLY name, and the textures that show them.
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
    bool clamped = false;  ///< else repeated
    bool is_data = false;  ///< numbers rather than colours
  };
  /// Index of the texture that shows `name` (`find_named`); `kInvalidId` and a warning where that
  /// leads out of the scene's folder.
  std::uint32_t add(const std::string& name, Use use, const std::string& named_in,
                    const std::string& place);

  /// Decodes the images into the scene and drops textures whose image cannot be had, with warnings.
  /// What each texture became: another index or `kInvalidId`. Call once.
  [[nodiscard]] std::vector<std::uint32_t> finish();

 private:
  /// A path, and whether it is read as data.
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
  std::vector<Shown> shown_;  ///< one a texture
  std::set<std::string> warned_;
};

}  // namespace raysheaf::io
