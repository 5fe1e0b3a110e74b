// The appearance of a PLY file: the meaning of properties, textures and materials.
#pragma once

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "io/ply_header.h"
#include "io/texture_files.h"
#include "raysheaf/scene_description.h"

namespace raysheaf::io {

/// The meaning of a property of a vertex or face.
enum PlyRole {
  kX,
  kY,
  kZ,
  kNormalX,
  kNormalY,
  kNormalZ,
  kRed,
  kGreen,
  kBlue,
  kAlpha,
  kU,
  kV,
  kTexture,
  kRoles
};

/// -1 for other properties and for lists.
inline int role_of(const PlyProperty& property) {
  constexpr std::pair<std::string_view, PlyRole> kNames[] = {{"x", kX},
                                                             {"y", kY},
                                                             {"z", kZ},
                                                             {"nx", kNormalX},
                                                             {"ny", kNormalY},
                                                             {"nz", kNormalZ},
                                                             {"red", kRed},
                                                             {"green", kGreen},
                                                             {"blue", kBlue},
                                                             {"diffuse_red", kRed},
                                                             {"diffuse_green", kGreen},
                                                             {"diffuse_blue", kBlue},
                                                             {"alpha", kAlpha},
                                                             {"diffuse_alpha", kAlpha},
                                                             {"s", kU},
                                                             {"t", kV},
                                                             {"u", kU},
                                                             {"v", kV},
                                                             {"texture_u", kU},
                                                             {"texture_v", kV},
                                                             {"texture_s", kU},
                                                             {"texture_t", kV},
                                                             {"texnumber", kTexture}};
  if (property.is_list) return -1;
  for (const auto& [name, role] : kNames) {
    if (property.name == name) return role;
  }
  return -1;
}

/// The textures that a header names, with a material for each.
class PlyTextures {
 public:
  /// Reads the images into `scene`. Reads none if neither vertices nor faces have texture
  /// coordinates.
  void read(const PlyHeader& header, const SceneFile& from, SceneDescription& scene) {
    if (header.textures.empty() || !has_coordinates(header)) return;
    TextureFiles files(from, scene);
    std::vector<std::uint32_t> added;
    for (const std::string& name : header.textures)
      added.push_back(files.add(name, {}, from.path, "comment TextureFile"));
    const std::vector<std::uint32_t> index_of = files.finish();
    const auto found = [&](std::uint32_t t) { return t == kInvalidId ? t : index_of[t]; };
    const bool any = std::any_of(added.begin(), added.end(),
                                 [&](std::uint32_t t) { return found(t) != kInvalidId; });
    for (const std::uint32_t texture : added)
      if (any) textures_.push_back(found(texture));
  }
  [[nodiscard]] bool any() const { return !textures_.empty(); }
  /// Index of the material for a face with the texnumber `number`.
  [[nodiscard]] std::uint32_t material_of(double number) const {
    const bool is_there = number >= 0 && number < static_cast<double>(textures_.size());
    return is_there ? static_cast<std::uint32_t>(number) : plain_material();
  }
  /// Index of the material for faces without a texture.
  [[nodiscard]] std::uint32_t plain_material() const {
    return static_cast<std::uint32_t>(textures_.size());
  }
  /// Adds a material for each texture, and the plain one if it is used.
  void add_materials(Vec3 plain_color, bool uses_plain, SceneDescription& scene) const {
    Material plain;
    plain.name = "default";
    plain.double_sided = true;
    plain.base_color = {0.8f, 0.8f, 0.8f, 1};
    for (const std::uint32_t texture : textures_) {
      Material& material = scene.materials.emplace_back(plain);
      if (texture == kInvalidId) continue;
      material.base_color = {1, 1, 1, 1};
      material.base_color_texture.texture = texture;
    }
    plain.base_color = {plain_color.x, plain_color.y, plain_color.z, 1};
    if (uses_plain) scene.materials.push_back(plain);
  }

 private:
  static bool has_coordinates(const PlyHeader& header) {
    const PlyElement *vertices = header.find("vertex"), *faces = header.find("face");
    if (faces != nullptr && faces->find("texcoord") >= 0) return true;
    const auto has = [&](int role) {
      return vertices != nullptr &&
             std::any_of(vertices->properties.begin(), vertices->properties.end(),
                         [&](const PlyProperty& property) { return role_of(property) == role; });
    };
    return has(kU) && has(kV);
  }

  std::vector<std::uint32_t> textures_;  ///< `kInvalidId` if the image could not be decoded
};

}  // namespace raysheaf::io
