#include "io/gltf_json.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "io/gltf_rules.h"
#include "io/json_text.h"
#include "io/refuse.h"
#include "raysheaf/error.h"

namespace raysheaf::io {
namespace {

using nlohmann::json;

constexpr std::array kSupported = {"KHR_lights_punctual",
                                   "KHR_materials_transmission",
                                   "KHR_materials_ior",
                                   "KHR_materials_specular",
                                   "KHR_materials_emissive_strength",
                                   "KHR_materials_unlit",
                                   "KHR_texture_transform",
                                   "KHR_mesh_quantization"};
constexpr std::size_t kMaxStride = 252;

template <class T>
T get(const json& object, const char* name, T fallback) {
  const auto member = object.find(name);
  return member == object.end() ? fallback : member->get<T>();
}
const json& list(const json& root, const char* name) {
  static const json kEmpty = json::array();
  const auto member = root.find(name);
  return member == root.end() ? kEmpty : *member;
}

void check_version(const json& root, const char* field) {
  const auto version = root["asset"].find(field);
  if (version == root["asset"].end()) return;
  const std::string place = std::string("asset.") + field;
  if (!version->is_string()) refuse("is not a string", place);
  const std::string text = version->get<std::string>();
  const bool is_two = text.starts_with("2.") && (field[0] == 'v' || text == "2.0");
  if (is_two) return;
  refuse("glTF version \"" + printable(text) + "\" is not read, only 2.0", place,
         ErrorCode::kUnsupported);
}

void check_extensions(const json& root, GltfFacts& facts) {
  const auto supported = [](const std::string& name) {
    return std::find(kSupported.begin(), kSupported.end(), name) != kSupported.end();
  };
  for (const json& name : list(root, "extensionsRequired")) {
    if (supported(name)) continue;
    refuse("the file requires the extension \"" + printable(name) + "\", which is not supported",
           "extensionsRequired", ErrorCode::kUnsupported);
  }
  std::set<std::string> seen;
  for (const json& name : list(root, "extensionsUsed")) {
    const std::string text = name;
    if (supported(text) || !seen.insert(text).second) continue;
    facts.warnings.push_back("The extension \"" + printable(text) + "\" is left out.");
  }
}

/// The bytes that a data URI stands for; refuses kinds that the parser does not know.
std::size_t data_uri_bytes(const std::string& uri, const std::string& place) {
  constexpr std::array kKinds = {"application/octet-stream",
                                 "application/gltf-buffer",
                                 "image/jpeg",
                                 "image/png",
                                 "image/bmp",
                                 "image/gif",
                                 "text/plain"};
  const std::size_t comma = uri.find(',');
  const std::string head = uri.substr(5, std::min<std::size_t>(comma, 64) - 5);
  const bool known = std::any_of(kKinds.begin(), kKinds.end(), [&](const char* kind) {
    return head == std::string(kind) + ";base64";
  });
  if (comma == uri.npos || !known) {
    refuse("is a data URI of a kind that is not read: \"" + printable(head) + "\"", place,
           ErrorCode::kUnsupported);
  }
  std::size_t digits = uri.size() - comma - 1;
  while (digits > 0 && uri[comma + digits] == '=') --digits;
  return digits / 4 * 3 + (digits % 4 == 0 ? 0 : digits % 4 - 1);
}

void check_length(std::size_t said, std::size_t there, const std::string& place) {
  if (said <= there) return;
  refuse("is " + std::to_string(said) + ", but there are only " + std::to_string(there) + " bytes",
         place + ".byteLength");
}

void check_buffer(const json& buffer, std::size_t i, const GltfParts& parts, const SceneFile& from,
                  GltfFacts& facts) {
  const std::string place = element("buffers", i);
  const std::size_t said = buffer["byteLength"];
  const std::string uri = get<std::string>(buffer, "uri", "");
  if (uri.empty()) {
    if (i != 0 || !parts.is_glb) refuse("the buffer has no data: no uri", place);
    check_length(said, parts.binary.size(), place);
  } else if (uri.starts_with("data:")) {
    const std::size_t there = data_uri_bytes(uri, place + ".uri");
    if (said != there) {
      refuse("is " + std::to_string(said) + ", but the data URI holds " + std::to_string(there) +
                 " bytes",
             place + ".byteLength");
    }
  } else {
    const std::string path = resolve(from, uri, true, place + ".uri");
    if (!file_exists(path)) {
      refuse("no such file \"" + printable(uri) + "\"", place + ".uri", ErrorCode::kNotFound);
    }
    auto& wanted = facts.buffer_files[path];
    wanted = std::max(wanted, said);
  }
}

void check_image(const json& image, std::size_t i, const SceneFile& from) {
  const std::string place = element("images", i);
  if (image.contains("uri") == image.contains("bufferView")) {
    refuse("an image needs either a uri or a bufferView", place);
  }
  const std::string uri = get<std::string>(image, "uri", "data:");
  if (!uri.starts_with("data:")) {
    static_cast<void>(resolve(from, uri, true, place + ".uri"));
  } else if (image.contains("uri")) {
    static_cast<void>(data_uri_bytes(uri, place + ".uri"));
  }
}

void check_view(const json& root, const json& view, std::size_t i) {
  const std::string place = element("bufferViews", i);
  const std::size_t buffer = view["buffer"];
  const std::size_t bytes = root["buffers"][buffer]["byteLength"];
  const std::size_t offset = get<std::size_t>(view, "byteOffset", 0), length = view["byteLength"];
  if (offset + length > bytes) {
    refuse("byteOffset + byteLength is " + std::to_string(offset + length) + ", but " +
               element("buffers", buffer) + " has " + std::to_string(bytes) + " bytes",
           place);
  }
  const std::size_t stride = get<std::size_t>(view, "byteStride", 4);
  if (stride % 4 != 0 || stride > kMaxStride) {
    refuse("is " + std::to_string(stride) + ", but must be a multiple of 4 from 4 to 252",
           place + ".byteStride");
  }
}

std::size_t component_bytes(int type, const std::string& place) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      refuse("is " + std::to_string(type) + ", which is no component type", place);
  }
}

std::size_t component_count(const std::string& type, const std::string& place) {
  constexpr std::pair<const char*, std::size_t> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  for (const auto& [name, count] : kTypes) {
    if (type == name) return count;
  }
  refuse("is \"" + printable(type) + "\", which is no type of accessors", place);
}

/// `count` elements of `size` bytes, `stride` apart, must lie within view `view` from `offset` on.
void check_fits(const json& root, std::size_t view, std::size_t offset, std::size_t count,
                std::size_t size, std::size_t stride, const std::string& place) {
  const std::size_t length = root["bufferViews"][view]["byteLength"];
  const bool fits =
      offset <= length && size <= length - offset && (length - offset - size) / stride >= count - 1;
  if (fits) return;
  refuse(std::to_string(count) + " elements of " + std::to_string(size) + " bytes from byte " +
             std::to_string(offset) + " on do not fit into the " + std::to_string(length) +
             " bytes of " + element("bufferViews", view),
         place);
}

void check_sparse(const json& root, const json& accessor, std::size_t size,
                  const std::string& place) {
  const json& sparse = accessor["sparse"];
  const std::size_t count = sparse["count"], total = accessor["count"];
  if (count > total) {
    refuse("is " + std::to_string(count) + ", but the accessor has " + std::to_string(total) +
               " elements",
           place + ".sparse.count");
  }
  const json &indices = sparse["indices"], &values = sparse["values"];
  const int type = indices["componentType"];
  if (type != 5121 && type != 5123 && type != 5125) {
    refuse("is no unsigned integer type", place + ".sparse.indices.componentType");
  }
  const std::size_t index_bytes = component_bytes(type, place);
  check_fits(root, indices["bufferView"], get<std::size_t>(indices, "byteOffset", 0), count,
             index_bytes, index_bytes, place + ".sparse.indices");
  check_fits(root, values["bufferView"], get<std::size_t>(values, "byteOffset", 0), count, size,
             size, place + ".sparse.values");
}

void check_accessor(const json& root, const json& accessor, std::size_t i) {
  const std::string place = element("accessors", i);
  const std::size_t count = accessor["count"];
  const std::size_t size = component_bytes(accessor["componentType"], place + ".componentType") *
                           component_count(accessor["type"], place + ".type");
  if (!accessor.contains("bufferView")) {
    if (count > kMaxUnbackedElements) {
      refuse("is " + std::to_string(count) + ", but without a bufferView at most 2^18 are read",
             place + ".count", ErrorCode::kOutOfMemory);
    }
  } else {
    const std::size_t view = accessor["bufferView"];
    const std::size_t said = get<std::size_t>(root["bufferViews"][view], "byteStride", 0);
    if (said != 0 && said < size) {
      refuse("is " + std::to_string(said) + ", less than the " + std::to_string(size) +
                 " bytes of an element of " + place,
             element("bufferViews", view) + ".byteStride");
    }
    check_fits(root, view, get<std::size_t>(accessor, "byteOffset", 0), count, size,
               said == 0 ? size : said, place);
  }
  if (accessor.contains("sparse")) check_sparse(root, accessor, size, place);
}

/// The parser below insists on a buffer view for indices.
void check_index_accessors(const json& root) {
  const json& meshes = list(root, "meshes");
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const json& primitives = meshes[m]["primitives"];
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      if (!primitives[p].is_object()) {
        refuse("is not an object", element("meshes", m) + "." + element("primitives", p));
      }
      const auto indices = primitives[p].find("indices");
      if (indices == primitives[p].end()) continue;
      const std::size_t accessor = *indices;
      if (root["accessors"][accessor].contains("bufferView")) continue;
      refuse("indices without a bufferView are not read",
             element("meshes", m) + "." + element("primitives", p) + ".indices",
             ErrorCode::kUnsupported);
    }
  }
}

}  // namespace

GltfFacts check_gltf_json(const GltfParts& parts, const SceneFile& from) {
  const json root = parse_json(parts.json);
  check_rules(root);
  GltfFacts facts;
  check_version(root, "version");
  check_version(root, "minVersion");
  check_extensions(root, facts);
  const auto each = [&](const char* name, const auto& check) {
    const json& items = list(root, name);
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (!items[i].is_object()) refuse("is not an object", element(name, i));
      check(items[i], i);
    }
  };
  each("buffers", [&](const json& x, std::size_t i) { check_buffer(x, i, parts, from, facts); });
  each("images", [&](const json& x, std::size_t i) { check_image(x, i, from); });
  each("bufferViews", [&](const json& x, std::size_t i) { check_view(root, x, i); });
  each("accessors", [&](const json& x, std::size_t i) { check_accessor(root, x, i); });
  check_index_accessors(root);
  return facts;
}

}  // namespace raysheaf::io
