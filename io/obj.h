// Loads Wavefront OBJ with MTL.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "io/file.h"
#include "io/named_file.h"
#include "io/texture_files.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

[[nodiscard]] SceneDescription load_obj(const Bytes& file, const SceneFile& from);

/// The material libraries of an OBJ file: materials by name, and their textures.
class MtlLibrary {
 public:
  MtlLibrary(const SceneFile& from, SceneDescription& scene)
      : from_(from), scene_(scene), textures_(from, scene) {}

  /// Reads the files on an mtllib line: one whose name may contain spaces, or several.
  void add(const std::string& names);
  /// Index of the material. If no material has this name, adds a warning and returns a grey one.
  [[nodiscard]] std::uint32_t find(const std::string& name);
  /// Index of the material for faces without one.
  [[nodiscard]] std::uint32_t fallback();
  /// Makes the fallback material white, because the mesh has vertex colours.
  void whiten_fallback();
  /// Decodes the images. Call it once, after the last `add`.
  void finish();

 private:
  void read(const std::string& name, const NamedFile& file);
  void warn_of_library(const std::string& name, const Error& error);
  /// Moves masks into the alpha of base colours, as new images, unless the mask and the colours are
  /// the same image.
  void cut_out();
  void warn_once(const std::string& sentence);
  void warn_of_names();
  friend class MtlConverter;

  /// The channel that a material's map_d uses.
  struct Mask {
    std::uint32_t material;
    TextureSlot slot;
    char channel;  ///< as in -imfchan
  };

  const SceneFile& from_;
  SceneDescription& scene_;
  std::vector<Mask> masks_;
  std::map<std::string, std::uint32_t> by_name_;
  TextureFiles textures_;
  std::set<std::string> read_, warned_;
  std::vector<std::string> missing_, twice_;
  std::uint32_t fallback_ = kInvalidId;
};

}  // namespace raysheaf::io
