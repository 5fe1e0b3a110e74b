#include "io/gltf_json.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "io/data_uri.h"
#include "io/gltf_draco.h"
#include "io/gltf_meshopt.h"
#include "io/gltf_rules.h"
#include "io/image_formats.h"
#include "io/refuse.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

constexpr std::array kSupported = {"KHR_lights_punctual",     "KHR_materials_transmission",
                                   "KHR_materials_volume",    "KHR_materials_ior",
                                   "KHR_materials_specular",  "KHR_materials_emissive_strength",
                                   "KHR_materials_unlit",     "KHR_materials_pbrSpecularGlossiness",
                                   "KHR_texture_transform",   "KHR_mesh_quantization",
                                   "EXT_mesh_gpu_instancing", "KHR_node_visibility",
                                   "KHR_animation_pointer"};
/// Extensions that a viewer may leave out although a file requires them: metadata, interaction,
/// sound, physics, other levels of detail, and other looks to choose from.
constexpr std::array kOptional = {
    "KHR_materials_variants", "KHR_xmp_json_ld",          "KHR_xmp",
    "KHR_interactivity",      "KHR_node_selectability",   "KHR_node_hoverability",
    "KHR_audio_emitter",      "KHR_physics_rigid_bodies", "KHR_implicit_shapes",
    "KHR_collision_shapes",   "EXT_structural_metadata",  "EXT_mesh_features",
    "EXT_instance_features",  "EXT_feature_metadata",     "CESIUM_primitive_outline",
    "AGI_articulations",      "AGI_stk_metadata",         "MSFT_lod"};
constexpr std::size_t kMaxStride = 252;
constexpr const char* kConvertKtx =
    "convert its KTX textures to PNG, as `gltf-transform ktxdecompress in.glb out.glb` does";

/// Checked before anything else: in another version, fields may have other types.
void check_version(const JsonValue& root, const char* field) {
  const JsonValue* asset = root.find("asset");
  const JsonValue* version = asset == nullptr ? nullptr : asset->find(field);
  if (version == nullptr) return;
  const std::string place = std::string("asset.") + field;
  if (!version->is_string()) refuse("is not a string", place);
  const auto text = version->get<std::string>();
  const bool is_two = text.starts_with("2.") && (field[0] == 'v' || text == "2.0");
  if (is_two) return;
  refuse("glTF version \"" + printable(text) + "\" is not read, only 2.0", place,
         ErrorCode::kUnsupported);
}

void check_extensions(const JsonValue& root, std::vector<std::string>& warnings) {
  const auto supported = [](const std::string& name) {
    return std::find(kSupported.begin(), kSupported.end(), name) != kSupported.end() ||
           ((name == kMeshopt || name == kKhrMeshopt) && unpacks_meshopt()) ||
           (name == kDraco && unpacks_draco()) || (name == "EXT_texture_webp" && reads_webp());
  };
  const auto is_optional = [](const std::string& name) {
    return std::find(kOptional.begin(), kOptional.end(), name) != kOptional.end();
  };
  for (const JsonValue& item : root.items("extensionsRequired")) {
    const auto name = item.get<std::string>();
    if (supported(name) || is_optional(name)) continue;
    if (name == "KHR_texture_basisu") {
      refuse(std::string("the file requires the extension \"KHR_texture_basisu\", which is not "
                         "supported: ") +
                 kConvertKtx,
             "extensionsRequired", ErrorCode::kUnsupported);
    }
    refuse("the file requires the extension \"" + printable(name) + "\", which is not supported",
           "extensionsRequired", ErrorCode::kUnsupported);
  }
  std::set<std::string> seen;
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    for (const JsonValue& item : root.items(list)) {
      const auto name = item.get<std::string>();
      if (supported(name) || !seen.insert(name).second) continue;
      if (name == "KHR_texture_basisu") {
        warnings.push_back(std::string("The extension \"KHR_texture_basisu\" is left out: ") +
                           kConvertKtx + ".");
        continue;
      }
      warnings.push_back("The extension \"" + printable(name) + "\" is left out.");
    }
  }
}

void check_length(std::size_t said, std::size_t there, const std::string& place) {
  if (said <= there) return;
  refuse("is " + std::to_string(said) + ", but there are only " + std::to_string(there) + " bytes",
         place + ".byteLength");
}

void check_buffer(const JsonValue& buffer, std::size_t i, const GltfParts& parts,
                  const SceneFile& from) {
  const std::string place = element("buffers", i);
  const auto said = buffer.at("byteLength").get<std::size_t>();
  const auto uri = buffer.get("uri", std::string_view());
  if (!has_bytes(buffer, i, parts)) return;
  if (uri.empty()) {
    check_length(said, parts.binary.size(), place);
  } else if (is_data_uri(uri)) {
    return;  // the decoder finds out its length
  } else if (!file_exists(resolve(from, std::string(uri), true, place + ".uri"))) {
    refuse("no such file \"" + printable(std::string(uri)) + "\"", place + ".uri",
           ErrorCode::kNotFound);
  }
}

void check_image(const JsonValue& image, std::size_t i, const SceneFile& from) {
  const std::string place = element("images", i);
  if (image.contains("uri") == image.contains("bufferView")) {
    refuse("an image needs either a uri or a bufferView", place);
  }
  if (!image.contains("uri")) return;
  const auto uri = image.at("uri").get<std::string_view>();
  // The decoder checks the contents of data URIs.
  if (!is_data_uri(uri)) static_cast<void>(resolve(from, std::string(uri), true, place + ".uri"));
}

void require_bytes(const JsonValue& root, std::size_t buffer, const GltfParts& parts,
                   const std::string& place) {
  if (!has_bytes(root.at("buffers").at(buffer), buffer, parts))
    refuse("is " + std::to_string(buffer) + ", a buffer without data", place);
}

void check_view(const JsonValue& root, const JsonValue& view, std::size_t i,
                const GltfParts& parts) {
  const std::string place = element("bufferViews", i);
  const auto buffer = view.at("buffer").get<std::size_t>();
  const auto bytes = root.at("buffers").at(buffer).at("byteLength").get<std::size_t>();
  const auto offset = view.get("byteOffset", std::size_t{0});
  const auto length = view.at("byteLength").get<std::size_t>();
  if (offset + length > bytes) {
    refuse("byteOffset + byteLength is " + std::to_string(offset + length) + ", but " +
               element("buffers", buffer) + " has " + std::to_string(bytes) + " bytes",
           place);
  }
  if (const MeshoptPacking packing = meshopt_packing(view); packing.json != nullptr) {
    require_bytes(root, packing.json->at("buffer").get<std::size_t>(), parts,
                  place + ".extensions." + packing.name + ".buffer");
    check_meshopt(root, view, place);
  } else {
    require_bytes(root, buffer, parts, place + ".buffer");
  }
  const auto stride = view.get("byteStride", std::size_t{4});
  if (stride % 4 != 0 || stride > kMaxStride) {
    refuse("is " + std::to_string(stride) + ", but must be a multiple of 4 from 4 to 252",
           place + ".byteStride");
  }
}

/// Bytes per element.
std::size_t element_bytes(const JsonValue& accessor, const std::string& place) {
  const int component = accessor.at("componentType").get<int>();
  const std::size_t bytes = component_bytes(component);
  if (bytes == 0) {
    refuse("is " + std::to_string(component) + ", which is not a component type",
           place + ".componentType");
  }
  const auto type = accessor.at("type").get<std::string>();
  const std::size_t count = component_count(type);
  if (count == 0) {
    refuse("is \"" + printable(type) + "\", which is not an accessor type", place + ".type");
  }
  return bytes * count;
}

/// `count` elements of `size` bytes, `stride` apart, must lie within view `view` from `offset` on.
void check_fits(const JsonValue& root, std::size_t view, std::size_t offset, std::size_t count,
                std::size_t size, std::size_t stride, const std::string& place) {
  const auto length = root.at("bufferViews").at(view).at("byteLength").get<std::size_t>();
  const bool fits =
      offset <= length && size <= length - offset && (length - offset - size) / stride >= count - 1;
  if (fits) return;
  refuse(std::to_string(count) + " elements of " + std::to_string(size) + " bytes from byte " +
             std::to_string(offset) + " on do not fit into the " + std::to_string(length) +
             " bytes of " + element("bufferViews", view),
         place);
}

void check_sparse(const JsonValue& root, const JsonValue& accessor, std::size_t size,
                  const std::string& place) {
  const JsonValue& sparse = accessor.at("sparse");
  const auto count = sparse.at("count").get<std::size_t>();
  const auto total = accessor.at("count").get<std::size_t>();
  if (count > total) {
    refuse("is " + std::to_string(count) + ", but the accessor has " + std::to_string(total) +
               " elements",
           place + ".sparse.count");
  }
  const int type = sparse.at("indices").at("componentType").get<int>();
  if (type != kGltfUnsignedByte && type != kGltfUnsignedShort && type != kGltfUnsignedInt) {
    refuse("is not an unsigned integer type", place + ".sparse.indices.componentType");
  }
  const auto check_part = [&](const char* name, std::size_t bytes) {
    const JsonValue& part = sparse.at(name);
    check_fits(root, part.at("bufferView").get<std::size_t>(),
               part.get("byteOffset", std::size_t{0}), count, bytes, bytes,
               place + ".sparse." + name);
  };
  check_part("indices", component_bytes(type));
  check_part("values", size);
}

/// `is_filled`: decompression provides the values, and the accessor's buffer view is ignored.
void check_accessor(const JsonValue& root, const JsonValue& accessor, std::size_t i,
                    bool is_filled) {
  const std::string place = element("accessors", i);
  const auto count = accessor.at("count").get<std::size_t>();
  const std::size_t size = element_bytes(accessor, place);
  if (!is_filled && !accessor.contains("bufferView")) {
    if (count > kMaxUnbackedElements) {
      refuse("is " + std::to_string(count) + ", but without a bufferView at most 2^18 are read",
             place + ".count", ErrorCode::kOutOfMemory);
    }
  } else if (!is_filled) {
    const auto view = accessor.at("bufferView").get<std::size_t>();
    const auto said = root.at("bufferViews").at(view).get("byteStride", std::size_t{0});
    if (said != 0 && said < size) {
      refuse("is " + std::to_string(said) + ", less than the " + std::to_string(size) +
                 " bytes of an element of " + place,
             element("bufferViews", view) + ".byteStride");
    }
    check_fits(root, view, accessor.get("byteOffset", std::size_t{0}), count, size,
               said == 0 ? size : said, place);
  }
  if (accessor.contains("sparse")) check_sparse(root, accessor, size, place);
}

/// `AccessorReader::indices` reads only accessors that were checked here.
void check_index_accessors(const JsonValue& root, const std::vector<bool>& is_filled) {
  const auto meshes = root.items("meshes");
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const auto primitives = meshes[m].items("primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const std::string place = element("meshes", m) + "." + element("primitives", p);
      if (!primitives[p].is_object()) refuse("is not an object", place);
      const JsonValue* indices = primitives[p].find("indices");
      if (indices == nullptr) continue;
      const auto accessor = indices->get<std::size_t>();
      if (is_filled[accessor] || root.at("accessors").at(accessor).contains("bufferView")) continue;
      refuse("indices without a bufferView are not read", place + ".indices",
             ErrorCode::kUnsupported);
    }
  }
}

void check_camera(const JsonValue& camera, std::size_t i) {
  const std::string place = element("cameras", i);
  const auto type = camera.at("type").get<std::string>();
  if (type != "perspective" && type != "orthographic") {
    refuse("is \"" + printable(type) + "\", which is neither perspective nor orthographic",
           place + ".type");
  }
  if (!camera.contains(type)) refuse("is missing", place + "." + type);
}

void check_light(const JsonValue& light, std::size_t i) {
  if (light.at("type").get<std::string_view>() == "spot" && !light.contains("spot"))
    refuse("is missing", element("extensions.KHR_lights_punctual.lights", i) + ".spot");
}

}  // namespace

bool has_bytes(const JsonValue& buffer, std::size_t index, const GltfParts& parts) {
  return !buffer.get("uri", std::string_view()).empty() || (parts.is_glb && index == 0);
}

std::size_t component_bytes(int type) {
  switch (type) {
    case kGltfByte:
    case kGltfUnsignedByte:
      return 1;
    case kGltfShort:
    case kGltfUnsignedShort:
      return 2;
    case kGltfUnsignedInt:
    case kGltfFloat:
      return 4;
    default:
      return 0;
  }
}

std::size_t component_count(std::string_view type) {
  constexpr std::pair<std::string_view, std::size_t> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  for (const auto& [name, count] : kTypes) {
    if (type == name) return count;
  }
  return 0;
}

const JsonValue* extension(const JsonValue& object, const char* name) {
  const JsonValue* all = object.find("extensions");
  return all == nullptr ? nullptr : all->find(name);
}

std::span<const JsonValue> gltf_lights(const JsonValue& root) {
  const JsonValue* punctual = extension(root, "KHR_lights_punctual");
  return punctual == nullptr ? std::span<const JsonValue>{} : punctual->items("lights");
}

std::vector<std::string> check_gltf_json(const JsonValue& root, const GltfParts& parts,
                                         const SceneFile& from) {
  check_version(root, "version");
  check_version(root, "minVersion");
  check_rules(root);
  std::vector<std::string> warnings;
  check_extensions(root, warnings);
  const auto each = [](std::span<const JsonValue> items, const auto& check) {
    for (std::size_t i = 0; i < items.size(); ++i) check(items[i], i);
  };
  using Item = const JsonValue&;
  each(root.items("buffers"), [&](Item x, std::size_t i) { check_buffer(x, i, parts, from); });
  each(root.items("images"), [&](Item x, std::size_t i) { check_image(x, i, from); });
  each(root.items("bufferViews"), [&](Item x, std::size_t i) { check_view(root, x, i, parts); });
  const std::vector<bool> is_filled = check_draco(root);
  each(root.items("accessors"),
       [&](Item x, std::size_t i) { check_accessor(root, x, i, is_filled[i]); });
  each(root.items("cameras"), check_camera);
  each(gltf_lights(root), check_light);
  check_index_accessors(root, is_filled);
  return warnings;
}

}  // namespace raysheaf::io
