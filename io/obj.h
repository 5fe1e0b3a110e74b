// Wavefront OBJ with MTL.
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

/// The material libraries of an OBJ file: materials by name, and what they show.
class MtlLibrary {
 public:
  MtlLibrary(const SceneFile& from, SceneDescription& scene)
      : from_(from), scene_(scene), textures_(from, scene) {}

  /// Reads the files that an mtllib line names: one whose name may hold spaces, or several.
  void add(const std::string& names);
  /// Index of the material, or of a grey one where there is none of this name (a warning).
  [[nodiscard]] std::uint32_t find(const std::string& name);
  /// Index of the material of faces that name none.
  [[nodiscard]] std::uint32_t fallback();
  /// What has colours of its own is not grey besides.
  void whiten_fallback();
  /// Decodes the images. Call once, after the last `add`.
  void finish();

 private:
  void read(const std::string& name, const NamedFile& file);
  void warn_of_library(const std::string& name, const Error& error);
  /// What masks say goes to the alpha of base colours: into pictures of their own, but where both
  /// are one.
  void cut_out();
  void warn_once(const std::string& sentence);
  void warn_of_names();
  friend class MtlConverter;

  /// What a material's map_d reads.
  struct Mask {
    std::uint32_t material;
    TextureSlot slot;
    char channel;  ///< of the picture, as -imfchan calls it
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
