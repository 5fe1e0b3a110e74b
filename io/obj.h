// Wavefront OBJ with MTL.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "io/file.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

[[nodiscard]] SceneDescription load_obj(const Bytes& file, const SceneFile& from);

/// The material libraries of an OBJ file: materials by name, and what they show.
class MtlLibrary {
 public:
  MtlLibrary(const SceneFile& from, SceneDescription& scene) : from_(from), scene_(scene) {}

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
  void read(const std::string& name);
  std::uint32_t texture(const std::string& name, bool clamped, const std::string& place);
  /// Decodes the pictures into the scene; where each path's went.
  std::map<std::string, std::uint32_t> read_images();
  /// What masks say goes to the alpha of base colours: into pictures of their own, but where both
  /// are one.
  void cut_out();
  void warn_once(const std::string& sentence);
  void warn_of_missing_materials();
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
  std::map<std::string, std::uint32_t> texture_of_;
  std::vector<std::string> image_paths_;  ///< one a texture, until `finish`
  std::set<std::string> read_, warned_;
  std::vector<std::string> missing_;
  std::uint32_t fallback_ = kInvalidId;
};

}  // namespace raysheaf::io
