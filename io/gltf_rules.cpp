#include "io/gltf_rules.h"

#include <cmath>
#include <limits>
#include <string_view>

#include "io/json_value.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

using enum JsonKind;

constexpr double kMaxSize = 0x1p53;

constexpr JsonRule kRules[] = {
    {"asset", kObject, true},
    {"asset.version", kString, true},
    {"extensionsUsed", kStrings},
    {"extensionsRequired", kStrings},
    {"scene", kIndex, false, 0, "scenes"},
    {"scenes", kArray},
    {"scenes[].name", kString},
    {"scenes[].nodes", kIndices, false, 0, "nodes"},
    {"nodes", kArray},
    {"nodes[].name", kString},
    {"nodes[].children", kIndices, false, 0, "nodes"},
    {"nodes[].mesh", kIndex, false, 0, "meshes"},
    {"nodes[].camera", kIndex, false, 0, "cameras"},
    {"nodes[].skin", kIndex, false, 0, "skins"},
    {"nodes[].matrix", kNumbers, false, 16},
    {"nodes[].translation", kNumbers, false, 3},
    {"nodes[].rotation", kNumbers, false, 4},
    {"nodes[].scale", kNumbers, false, 3},
    {"nodes[].weights", kNumbers},
    {"nodes[].extensions", kObject},
    {"nodes[].extensions.KHR_lights_punctual", kObject},
    {"nodes[].extensions.KHR_lights_punctual.light", kIndex, true, 0,
     "extensions.KHR_lights_punctual.lights"},
    {"nodes[].extensions.KHR_node_visibility", kObject},
    {"nodes[].extensions.KHR_node_visibility.visible", kBool},
    {"nodes[].extensions.EXT_mesh_gpu_instancing", kObject},
    {"nodes[].extensions.EXT_mesh_gpu_instancing.attributes", kIndexMap, true, 0, "accessors"},
    {"meshes", kArray},
    {"meshes[].name", kString},
    {"meshes[].weights", kNumbers},
    {"meshes[].primitives", kArray, true},
    {"meshes[].primitives[].attributes", kIndexMap, true, 0, "accessors"},
    {"meshes[].primitives[].indices", kIndex, false, 0, "accessors"},
    {"meshes[].primitives[].material", kIndex, false, 0, "materials"},
    {"meshes[].primitives[].mode", kInt},
    {"meshes[].primitives[].targets", kIndexMaps, false, 0, "accessors"},
    {"meshes[].primitives[].extensions", kObject},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression", kObject},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression.bufferView", kIndex, true, 0,
     "bufferViews"},
    {"meshes[].primitives[].extensions.KHR_draco_mesh_compression.attributes", kObject, true},
    {"accessors", kArray},
    {"accessors[].name", kString},
    {"accessors[].bufferView", kIndex, false, 0, "bufferViews"},
    {"accessors[].byteOffset", kSize},
    {"accessors[].componentType", kInt, true},
    {"accessors[].normalized", kBool},
    {"accessors[].count", kPositive, true},
    {"accessors[].type", kString, true},
    {"accessors[].sparse", kObject},
    {"accessors[].sparse.count", kPositive, true},
    {"accessors[].sparse.indices", kObject, true},
    {"accessors[].sparse.indices.bufferView", kIndex, true, 0, "bufferViews"},
    {"accessors[].sparse.indices.byteOffset", kInt},
    {"accessors[].sparse.indices.componentType", kInt, true},
    {"accessors[].sparse.values", kObject, true},
    {"accessors[].sparse.values.bufferView", kIndex, true, 0, "bufferViews"},
    {"accessors[].sparse.values.byteOffset", kInt},
    {"bufferViews", kArray},
    {"bufferViews[].name", kString},
    {"bufferViews[].buffer", kIndex, true, 0, "buffers"},
    {"bufferViews[].byteOffset", kSize},
    {"bufferViews[].byteLength", kSize, true},
    {"bufferViews[].byteStride", kSize},
    {"bufferViews[].extensions", kObject},
    {"bufferViews[].extensions.EXT_meshopt_compression", kObject},
    {"bufferViews[].extensions.EXT_meshopt_compression.buffer", kIndex, true, 0, "buffers"},
    {"bufferViews[].extensions.EXT_meshopt_compression.byteOffset", kSize},
    {"bufferViews[].extensions.EXT_meshopt_compression.byteLength", kPositive, true},
    {"bufferViews[].extensions.EXT_meshopt_compression.byteStride", kPositive, true},
    {"bufferViews[].extensions.EXT_meshopt_compression.count", kPositive, true},
    {"bufferViews[].extensions.EXT_meshopt_compression.mode", kString, true},
    {"bufferViews[].extensions.EXT_meshopt_compression.filter", kString},
    {"bufferViews[].extensions.KHR_meshopt_compression", kObject},
    {"bufferViews[].extensions.KHR_meshopt_compression.buffer", kIndex, true, 0, "buffers"},
    {"bufferViews[].extensions.KHR_meshopt_compression.byteOffset", kSize},
    {"bufferViews[].extensions.KHR_meshopt_compression.byteLength", kPositive, true},
    {"bufferViews[].extensions.KHR_meshopt_compression.byteStride", kPositive, true},
    {"bufferViews[].extensions.KHR_meshopt_compression.count", kPositive, true},
    {"bufferViews[].extensions.KHR_meshopt_compression.mode", kString, true},
    {"bufferViews[].extensions.KHR_meshopt_compression.filter", kString},
    {"buffers", kArray},
    {"buffers[].name", kString},
    {"buffers[].uri", kString},
    {"buffers[].byteLength", kPositive, true},
    {"buffers[].extensions", kObject},
    {"buffers[].extensions.EXT_meshopt_compression", kObject},
    {"buffers[].extensions.EXT_meshopt_compression.fallback", kBool},
    {"buffers[].extensions.KHR_meshopt_compression", kObject},
    {"buffers[].extensions.KHR_meshopt_compression.fallback", kBool},
    {"materials", kArray},
    {"materials[].name", kString},
    {"materials[].alphaMode", kString},
    {"materials[].alphaCutoff", kAmount},
    {"materials[].doubleSided", kBool},
    {"materials[].emissiveFactor", kAmounts, false, 3},
    {"materials[].pbrMetallicRoughness", kObject},
    {"materials[].pbrMetallicRoughness.baseColorFactor", kAmounts, false, 4},
    {"materials[].pbrMetallicRoughness.metallicFactor", kPart},
    {"materials[].pbrMetallicRoughness.roughnessFactor", kPart},
    {"materials[].extensions", kObject},
    {"materials[].extensions.KHR_materials_pbrSpecularGlossiness", kObject},
    {"materials[].extensions.KHR_materials_pbrSpecularGlossiness.diffuseFactor", kAmounts, false,
     4},
    {"materials[].extensions.KHR_materials_pbrSpecularGlossiness.specularFactor", kAmounts, false,
     3},
    {"materials[].extensions.KHR_materials_pbrSpecularGlossiness.glossinessFactor", kPart},
    {"materials[].extensions.KHR_materials_transmission", kObject},
    {"materials[].extensions.KHR_materials_transmission.transmissionFactor", kPart},
    {"materials[].extensions.KHR_materials_volume", kObject},
    {"materials[].extensions.KHR_materials_volume.thicknessFactor", kAmount},
    {"materials[].extensions.KHR_materials_volume.attenuationDistance", kAmount},
    {"materials[].extensions.KHR_materials_volume.attenuationColor", kAmounts, false, 3},
    {"materials[].extensions.KHR_materials_ior", kObject},
    {"materials[].extensions.KHR_materials_ior.ior", kNumber},
    {"materials[].extensions.KHR_materials_specular", kObject},
    {"materials[].extensions.KHR_materials_specular.specularFactor", kPart},
    {"materials[].extensions.KHR_materials_specular.specularColorFactor", kAmounts, false, 3},
    {"materials[].extensions.KHR_materials_emissive_strength", kObject},
    {"materials[].extensions.KHR_materials_emissive_strength.emissiveStrength", kAmount},
    {"materials[].extensions.KHR_materials_unlit", kObject},
    {"textures", kArray},
    {"textures[].name", kString},
    {"textures[].sampler", kIndex, false, 0, "samplers"},
    {"textures[].source", kIndex, false, 0, "images"},
    {"textures[].extensions", kObject},
    {"textures[].extensions.EXT_texture_webp", kObject},
    {"textures[].extensions.EXT_texture_webp.source", kIndex, false, 0, "images"},
    {"samplers", kArray},
    {"samplers[].magFilter", kInt},
    {"samplers[].minFilter", kInt},
    {"samplers[].wrapS", kInt},
    {"samplers[].wrapT", kInt},
    {"images", kArray},
    {"images[].name", kString},
    {"images[].uri", kString},
    {"images[].mimeType", kString},
    {"images[].bufferView", kIndex, false, 0, "bufferViews"},
    {"cameras", kArray},
    {"cameras[].name", kString},
    {"cameras[].type", kString, true},
    {"cameras[].perspective", kObject},
    {"cameras[].perspective.yfov", kNumber, true},
    {"cameras[].perspective.znear", kNumber, true},
    {"cameras[].perspective.zfar", kNumber},
    {"cameras[].perspective.aspectRatio", kNumber},
    {"cameras[].orthographic", kObject},
    {"cameras[].orthographic.xmag", kNumber, true},
    {"cameras[].orthographic.ymag", kNumber, true},
    {"cameras[].orthographic.znear", kNumber, true},
    {"cameras[].orthographic.zfar", kNumber, true},
    {"animations", kArray},
    {"skins", kArray},
    {"skins[].name", kString},
    {"skins[].joints", kIndices, true, 0, "nodes"},
    {"skins[].inverseBindMatrices", kIndex, false, 0, "accessors"},
    {"skins[].skeleton", kIndex, false, 0, "nodes"},
    {"extensions", kObject},
    {"extensions.KHR_lights_punctual", kObject},
    {"extensions.KHR_lights_punctual.lights", kArray, true},
    {"extensions.KHR_lights_punctual.lights[].name", kString},
    {"extensions.KHR_lights_punctual.lights[].type", kString, true},
    {"extensions.KHR_lights_punctual.lights[].color", kNumbers, false, 3},
    {"extensions.KHR_lights_punctual.lights[].intensity", kNumber},
    {"extensions.KHR_lights_punctual.lights[].range", kNumber},
    {"extensions.KHR_lights_punctual.lights[].spot", kObject},
    {"extensions.KHR_lights_punctual.lights[].spot.innerConeAngle", kNumber},
    {"extensions.KHR_lights_punctual.lights[].spot.outerConeAngle", kNumber},
};

/// Rules for a single animation.
constexpr JsonRule kAnimationRules[] = {
    {"name", kString},
    {"samplers", kArray, true},
    {"samplers[].input", kIndex, true, 0, "accessors"},
    {"samplers[].output", kIndex, true, 0, "accessors"},
    {"samplers[].interpolation", kString},
    {"channels", kArray, true},
    {"channels[].sampler", kInt, true},
    {"channels[].target", kObject, true},
    {"channels[].target.node", kIndex, false, 0, "nodes"},
    {"channels[].target.path", kString, true},
};

/// The places that refer to textures: each is an object with index, set and transform.
constexpr const char* kTextureSlots[] = {
    "materials[].pbrMetallicRoughness.baseColorTexture",
    "materials[].pbrMetallicRoughness.metallicRoughnessTexture",
    "materials[].extensions.KHR_materials_pbrSpecularGlossiness.diffuseTexture",
    "materials[].emissiveTexture",
    "materials[].normalTexture",
    "materials[].occlusionTexture",
};
constexpr JsonRule kSlotRules[] = {
    {"", kObject},
    {".index", kIndex, true, 0, "textures"},
    {".texCoord", kInt},
    {".extensions", kObject},
    {".extensions.KHR_texture_transform", kObject},
    {".extensions.KHR_texture_transform.offset", kNumbers, false, 2},
    {".extensions.KHR_texture_transform.scale", kNumbers, false, 2},
    {".extensions.KHR_texture_transform.rotation", kNumber},
    {".extensions.KHR_texture_transform.texCoord", kInt},
};

/// The path of a value, for error messages. The text is assembled only for an error.
struct Place {
  const Place* above = nullptr;
  std::string_view name;
  std::size_t index = kNoIndex;
  static constexpr std::size_t kNoIndex = static_cast<std::size_t>(-1);

  [[nodiscard]] std::string text() const {
    if (index != kNoIndex) return element(above->text(), index);
    const std::string own = printable(std::string(name));
    return above == nullptr ? own : above->text() + "." + own;
  }
};

class Checker {
 public:
  explicit Checker(const JsonValue& root) : root_(root) {}

  void check(const JsonRule& rule) const {
    if (!root_.is_object()) refuse("is not an object", "JSON root");
    descend(root_, rule.path, nullptr, rule);
  }
  /// Checks an object below the root; the rule's path is relative to it.
  void check(const JsonValue& value, const JsonRule& rule) const {
    if (!value.is_object()) refuse("is not an object");
    descend(value, rule.path, nullptr, rule);
  }

 private:
  void descend(const JsonValue& value, std::string_view path, const Place* above,
               const JsonRule& rule) const {
    const std::size_t dot = path.find('.');
    std::string_view name = path.substr(0, dot);
    const bool last = dot == std::string_view::npos;
    const bool each = name.ends_with("[]");
    if (each) name.remove_suffix(2);
    const Place here{above, name};
    const JsonValue* member = value.find(name);
    if (member == nullptr) {
      if (last && rule.required) refuse("is missing", here.text());
      return;
    }
    if (last) return check_value(*member, here, rule);
    const std::string_view rest = path.substr(dot + 1);
    if (!each) return check_inside(*member, rest, here, rule);
    require(member->is_array(), "an array", here);
    const auto items = member->items();
    for (std::size_t i = 0; i < items.size(); ++i)
      check_inside(items[i], rest, {&here, {}, i}, rule);
  }
  void check_inside(const JsonValue& value, std::string_view rest, const Place& place,
                    const JsonRule& rule) const {
    require(value.is_object(), "an object", place);
    descend(value, rest, &place, rule);
  }

  void check_value(const JsonValue& value, const Place& place, const JsonRule& rule) const {
    switch (rule.kind) {
      case kArray:
        return require(value.is_array(), "an array", place);
      case kObject:
        return require(value.is_object(), "an object", place);
      case kString:
        return require(value.is_string(), "a string", place);
      case kBool:
        return require(value.is_boolean(), "true or false", place);
      case kNumber:
        return check_number(value, place);
      case kPart:
        return check_part(value, place);
      case kAmount:
        return check_amount(value, place);
      case kSize:
        return check_integer(value, 0, kMaxSize, place);
      case kPositive:
        return check_integer(value, 1, kMaxSize, place);
      case kInt:
        return check_integer(value, 0, 0x7fffffff, place);
      case kIndex:
        return check_index(value, place, rule.target);
      case kIndexMap:
        return check_map(value, place, rule);
      default:
        return check_many(value, place, rule);
    }
  }
  void check_many(const JsonValue& value, const Place& place, const JsonRule& rule) const {
    require(value.is_array(), "an array", place);
    const auto items = value.items();
    if (rule.count > 0 && items.size() != static_cast<std::size_t>(rule.count)) {
      refuse("has " + std::to_string(items.size()) + " numbers instead of " +
                 std::to_string(rule.count),
             place.text());
    }
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Place here{&place, {}, i};
      if (rule.kind == kNumbers) check_number(items[i], here);
      if (rule.kind == kAmounts) check_amount(items[i], here);
      if (rule.kind == kStrings) require(items[i].is_string(), "a string", here);
      if (rule.kind == kIndices) check_index(items[i], here, rule.target);
      if (rule.kind == kIndexMaps) check_map(items[i], here, rule);
    }
  }
  void check_map(const JsonValue& value, const Place& place, const JsonRule& rule) const {
    require(value.is_object(), "an object", place);
    for (const JsonMember& member : value.members())
      check_index(member.value, {&place, member.name}, rule.target);
  }

  static void require(bool holds, const char* what, const Place& place) {
    if (!holds) refuse(std::string("is not ") + what, place.text());
  }
  static void check_number(const JsonValue& value, const Place& place) {
    require(value.is_number(), "a number", place);
    require(std::fabs(value.get<double>()) <= double{std::numeric_limits<float>::max()},
            "a number that a float can hold", place);
  }
  static void check_part(const JsonValue& value, const Place& place) {
    check_number(value, place);
    const auto part = value.get<float>();
    if (part < 0 || part > 1)
      refuse("is " + std::to_string(part) + ", but goes from 0 to 1", place.text());
  }
  static void check_amount(const JsonValue& value, const Place& place) {
    check_number(value, place);
    if (value.get<float>() < 0) refuse("is negative", place.text());
  }
  static void check_integer(const JsonValue& value, double least, double most, const Place& place) {
    require(value.is_integer(), "an integer", place);
    const double number = value.get<double>();
    if (number < least)
      refuse("is " + value.digits() + ", but must not be below " +
                 std::to_string(static_cast<int>(least)),
             place.text());
    if (number > most) refuse("is " + value.digits() + ", which is too large", place.text());
  }
  void check_index(const JsonValue& value, const Place& place, const char* target) const {
    check_integer(value, 0, 0x7fffffff, place);
    const std::size_t count = length_of(target);
    if (value.get<std::size_t>() < count) return;
    refuse("is " + value.digits() + ", but the file has " + std::to_string(count) + " " + target,
           place.text());
  }
  [[nodiscard]] std::size_t length_of(std::string_view path) const {
    const JsonValue* value = &root_;
    while (value != nullptr && !path.empty()) {
      const std::string_view name = path.substr(0, path.find('.'));
      value = value->find(name);
      path.remove_prefix(std::min(path.size(), name.size() + 1));
    }
    return value == nullptr ? 0 : value->items().size();
  }

  const JsonValue& root_;
};

}  // namespace

void check_animation(const JsonValue& root, const JsonValue& animation) {
  const Checker checker(root);
  for (const JsonRule& rule : kAnimationRules) checker.check(animation, rule);
}

void check_rules(const JsonValue& root) {
  const Checker checker(root);
  for (const JsonRule& rule : kRules) checker.check(rule);
  for (const char* slot : kTextureSlots) {
    for (JsonRule rule : kSlotRules) {
      const std::string path = std::string(slot) + rule.path;
      rule.path = path.c_str();
      checker.check(rule);
    }
  }
}

}  // namespace raysheaf::io
