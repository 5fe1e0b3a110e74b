#include <algorithm>
#include <cmath>
#include <tuple>

#include "io/gltf_rules.h"
#include "io/image.h"
#include "io/mtl_phong.h"
#include "io/mtl_statements.h"
#include "io/named_file.h"
#include "io/obj.h"
#include "io/refuse.h"
#include "io/text_lines.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

/// OBJ scales and moves v upwards from the bottom row; here v points down from the top.
TextureSlot slot_of(std::uint32_t texture, const MtlMap& map) {
  TextureSlot slot;
  slot.texture = texture;
  slot.scale = map.scale;
  slot.offset = {map.offset.x, 1 - map.scale.y - map.offset.y};
  return slot;
}

}  // namespace

/// Converts the materials of an MTL file.
class MtlConverter {
 public:
  /// `path` is the MTL file's path; `place` is its name in warnings.
  MtlConverter(MtlLibrary& library, const std::string& path, const std::string& place)
      : library_(library), path_(path), place_(place) {}

  Material convert(const MtlMaterial& m) {
    Material material = material_of(m);
    const MtlLook look = look_of(m);
    const bool clear = look == MtlLook::kGlass;
    if (!clear && m.diffuse_map.is_named()) material.base_color_texture = slot(m.diffuse_map);
    if (m.emission_map.is_named()) {
      material.emission_texture = slot(m.emission_map);
      if (largest_part(material.emission) == 0 && material.emission_texture.texture != kInvalidId) {
        material.emission = {1, 1, 1};
      }
    }
    if (m.normal_map.is_named()) {
      material.normal_texture = slot(m.normal_map, true);
      material.normal_scale = m.normal_map.bump_multiplier;
    }
    if (!clear && m.alpha_map.is_named()) {
      material.base_color.w = 1;
      material.alpha_cutoff = 0.5f;
      library_.masks_.push_back({static_cast<std::uint32_t>(library_.scene_.materials.size()),
                                 slot(m.alpha_map, true), m.alpha_map.channel});
      if (m.alpha_map.channel == 'z')
        library_.warn_once("Images have no depth: -imfchan z of map_d is left out.");
    }
    const bool refracts = clear || look == MtlLook::kTinted;
    if (!refracts && !m.alpha_map.is_named()) blend(m, material);
    warn_of_glass(m, look);
    // Many programs write the same map as both; ambient maps are ignored then.
    if (m.ambient_map.is_named() && m.ambient_map.name != m.diffuse_map.name)
      library_.warn_once("Ambient maps are left out.");
    return material;
  }

 private:
  /// Sets the transparency of materials that are neither glass nor have an alpha map.
  void blend(const MtlMaterial& m, Material& material) {
    if (m.dissolve > 0 && m.dissolve < 1) {
      material.base_color.w = m.dissolve;
      material.alpha_blend = true;
      library_.warn_once(
          "Materials with d below 1 and without Ni are blended by random samples; with one sample "
          "per pixel they are opaque.");
    } else if (m.is_invisible) {
      material.base_color.w = 0;
      material.alpha_blend = true;
      library_.warn_once("Materials whose d is 0 are invisible.");
    } else if (m.dissolve == 0) {
      material.base_color.w = 1;
      library_.warn_once(
          "Materials with Tr 1 and without d, or with d 0 and another Tr, are opaque.");
    }
  }
  TextureSlot slot(const MtlMap& map, bool is_data = false) {
    return slot_of(library_.textures_.add(unquoted(map.name), {map.clamp, is_data}, path_, place_),
                   map);
  }
  void warn_of_glass(const MtlMaterial& m, MtlLook look) {
    if (look == MtlLook::kGlass && (m.diffuse_map.is_named() || m.alpha_map.is_named()))
      library_.warn_once("Clear glass cannot have textures: its map_Kd and map_d are left out.");
    if ((look == MtlLook::kGlass || look == MtlLook::kTinted) && m.roughness > 0)
      library_.warn_once("Glass is smooth: its Pr is left out.");
    if (look == MtlLook::kTinted && largest_part(mtl_specular(m)) > 0)
      library_.warn_once(
          "The reflection of glass (d below 1 with Ni) follows Ni: its Ks and Ns are left out.");
  }

  MtlLibrary& library_;
  std::string path_, place_;
};

void MtlLibrary::warn_once(const std::string& sentence) {
  if (warned_.insert(sentence).second) scene_.warnings.push_back(sentence);
}

namespace {

/// For example "\"a\" and 2 more".
std::string first_and_more(const std::vector<std::string>& names) {
  const std::size_t others = names.size() - 1;
  return "\"" + printable(names.front()) + "\"" +
         (others == 0 ? "" : " and " + std::to_string(others) + " more");
}

}  // namespace

void MtlLibrary::warn_of_names() {
  if (!twice_.empty())
    warn_once("Materials are defined more than once (" + first_and_more(twice_) +
              "); the first definition of each counts.");
  if (!missing_.empty())
    warn_once("There is no material " + first_and_more(missing_) + "; a grey one stands in.");
}

void MtlLibrary::add(const std::string& names) {
  if (names.empty()) return warn_once("An mtllib line names no file.");
  const std::string whole = unquoted(names);
  try {
    if (const NamedFile file = find_named(from_, whole, from_.path, "mtllib"); file.is_there)
      return read(whole, file);
  } catch (const Error& error) {
    // Several names together may look like one path outside the folder.
    if (error.code() != ErrorCode::kUnsupported) throw;
  }
  for (const std::string& name : names_on(names)) {
    NamedFile file;
    try {
      file = find_named(from_, name, from_.path, "mtllib");
    } catch (const Error& error) {
      warn_of_library(name, error);
      continue;
    }
    read(name, file);
  }
}

void MtlLibrary::warn_of_library(const std::string& name, const Error& error) {
  warn_once("The material library \"" + printable(name) + "\" is left out: " + error.sentence() +
            ".");
}

void MtlLibrary::read(const std::string& name, const NamedFile& file) {
  if (!read_.insert(file.path).second) return;
  if (!file.remark.empty()) warn_once(file.remark);
  Bytes bytes;
  std::string_view text;
  try {
    bytes = read_file(file.path);
    text = text_of(bytes);
  } catch (const Error& error) {
    return warn_of_library(name, error);
  }
  MtlConverter converter(*this, file.path, printable(name));
  const auto warn = [&](const std::string& sentence) { warn_once(sentence); };
  const auto materials = naming(printable(name), [&] { return read_mtl(text, warn); });
  for (const MtlMaterial& material : materials) {
    const std::string& key = material.name;
    const auto index = static_cast<std::uint32_t>(scene_.materials.size());
    if (!by_name_.try_emplace(key, index).second) {
      twice_.push_back(key);
      continue;
    }
    scene_.materials.push_back(converter.convert(material));
    scene_.materials.back().name = key;
  }
}

std::uint32_t MtlLibrary::find(const std::string& name) {
  const auto known = by_name_.find(name);
  if (known != by_name_.end()) return known->second;
  missing_.push_back(name);
  return by_name_[name] = fallback();
}

std::uint32_t MtlLibrary::fallback() {
  if (fallback_ == kInvalidId) {
    Material grey;
    grey.name = "default";
    grey.base_color = {0.8f, 0.8f, 0.8f, 1};
    grey.double_sided = true;
    fallback_ = static_cast<std::uint32_t>(scene_.materials.size());
    scene_.materials.push_back(grey);
  }
  return fallback_;
}

void MtlLibrary::whiten_fallback() {
  if (fallback_ != kInvalidId) scene_.materials[fallback_].base_color = {1, 1, 1, 1};
}

namespace {

/// Whether any alpha differs from 255.
bool has_alpha(const Image& image) {
  for (std::size_t i = 3; i < image.rgba.size(); i += 4)
    if (image.rgba[i] != 255) return true;
  return false;
}

/// Red, green, blue, luminance (l; ITU-R BT.709), or alpha.
std::uint8_t alpha_of(const std::uint8_t* texel, char channel) {
  switch (channel) {
    case 'r':
      return texel[0];
    case 'g':
      return texel[1];
    case 'b':
      return texel[2];
    case 'l':
      return static_cast<std::uint8_t>(
          std::lround(0.2126 * texel[0] + 0.7152 * texel[1] + 0.0722 * texel[2]));
    default:
      return texel[3];
  }
}

/// Sets the alpha of `image`, which keeps its size, to a channel of the nearest texel in the mask.
/// If the channel is not red, green, blue or luminance, uses the mask's alpha if it has one, and
/// otherwise its luminance.
void set_alpha(const Image& mask, char channel, Image* image) {
  const bool is_chosen = channel == 'r' || channel == 'g' || channel == 'b' || channel == 'l';
  const char part = is_chosen ? channel : has_alpha(mask) ? 'm' : 'l';
  for (std::uint32_t y = 0; y < image->height; ++y) {
    const auto row = static_cast<std::uint32_t>((2 * std::uint64_t{y} + 1) * mask.height /
                                                (2 * std::uint64_t{image->height}));
    for (std::uint32_t x = 0; x < image->width; ++x) {
      const auto column = static_cast<std::uint32_t>((2 * std::uint64_t{x} + 1) * mask.width /
                                                     (2 * std::uint64_t{image->width}));
      image->rgba[4 * (std::size_t{y} * image->width + x) + 3] =
          alpha_of(&mask.rgba[4 * (std::size_t{row} * mask.width + column)], part);
    }
  }
}

}  // namespace

void MtlLibrary::cut_out() {
  std::map<std::tuple<std::uint32_t, std::uint32_t, char>, std::uint32_t> made;
  for (const Mask& mask : masks_) {
    Material& material = scene_.materials[mask.material];
    TextureSlot& base = material.base_color_texture;
    if (mask.slot.texture == kInvalidId) {
      material.alpha_cutoff = 0;
      continue;
    }
    const std::uint32_t mask_image = scene_.textures[mask.slot.texture].image;
    const bool is_plain = base.texture == kInvalidId;
    if (!is_plain && mask.channel == 'm' && scene_.textures[base.texture].image == mask_image &&
        has_alpha(scene_.images[mask_image]))
      continue;
    const auto [it, fresh] = made.try_emplace({base.texture, mask.slot.texture, mask.channel},
                                              static_cast<std::uint32_t>(scene_.textures.size()));
    if (fresh) {
      Texture texture = scene_.textures[is_plain ? mask.slot.texture : base.texture];
      Image image = scene_.images[texture.image];
      if (is_plain) std::fill(image.rgba.begin(), image.rgba.end(), std::uint8_t{255});
      set_alpha(scene_.images[mask_image], mask.channel, &image);
      texture.image = static_cast<std::uint32_t>(scene_.images.size());
      scene_.images.push_back(std::move(image));
      scene_.textures.push_back(texture);
    }
    if (is_plain) base = mask.slot;
    base.texture = it->second;
  }
}

void MtlLibrary::finish() {
  warn_of_names();
  const std::vector<std::uint32_t> index_of = textures_.finish();
  for (Material& material : scene_.materials) {
    for (TextureSlot* slot :
         {&material.base_color_texture, &material.emission_texture, &material.normal_texture}) {
      if (slot->texture != kInvalidId) slot->texture = index_of[slot->texture];
    }
  }
  for (Mask& mask : masks_)
    if (mask.slot.texture != kInvalidId) mask.slot.texture = index_of[mask.slot.texture];
  cut_out();
}

}  // namespace raysheaf::io
