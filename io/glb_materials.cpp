#include <algorithm>
#include <cmath>

#include "io/glb_writer.h"
#include "io/image.h"
#include "raysheaf/io.h"

namespace raysheaf::io {
namespace {

using nlohmann::json;

json numbers(Vec2 v) {
  return {v.x, v.y};
}
json numbers(Vec3 v) {
  return {v.x, v.y, v.z};
}
bool equal(Vec2 a, Vec2 b) {
  return a.x == b.x && a.y == b.y;
}
bool equal(Vec3 a, Vec3 b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

int gl_wrap(Wrap wrap) {
  return wrap == Wrap::kRepeat ? 10497 : wrap == Wrap::kMirroredRepeat ? 33648 : 33071;
}
json sampler_of(const Texture& texture) {
  const bool nearest = texture.filter == Filter::kNearest;
  return {{"magFilter", nearest ? 9728 : 9729},
          {"minFilter", nearest ? 9728 : 9729},
          {"wrapS", gl_wrap(texture.wrap_u)},
          {"wrapT", gl_wrap(texture.wrap_v)}};
}

std::size_t find_or_add(GlbParts& parts, const char* list, const json& item) {
  const auto known = parts.json.find(list);
  if (known != parts.json.end()) {
    const auto it = std::find(known->begin(), known->end(), item);
    if (it != known->end()) return static_cast<std::size_t>(it - known->begin());
  }
  return parts.add(list, item);
}

void write_slot(const TextureSlot& slot, const char* name, json& object, GlbParts& parts) {
  if (slot.texture == kInvalidId) return;
  json info = {{"index", slot.texture}};
  json transform = json::object();
  if (!equal(slot.offset, {0, 0})) transform["offset"] = numbers(slot.offset);
  if (!equal(slot.scale, {1, 1})) transform["scale"] = numbers(slot.scale);
  if (slot.rotation != 0) transform["rotation"] = slot.rotation;
  if (!transform.empty()) {
    info["extensions"]["KHR_texture_transform"] = transform;
    parts.extensions.insert("KHR_texture_transform");
  }
  object[name] = info;
}

json extensions_of(const Material& m) {
  json result = json::object();
  if (m.transmission != 0) {
    result["KHR_materials_transmission"] = {{"transmissionFactor", m.transmission}};
  }
  if (m.ior != 1.5f) result["KHR_materials_ior"] = {{"ior", m.ior}};
  if (m.specular != 1 || !equal(m.specular_color, {1, 1, 1})) {
    result["KHR_materials_specular"] = {{"specularFactor", m.specular},
                                        {"specularColorFactor", numbers(m.specular_color)}};
  }
  if (m.unlit) result["KHR_materials_unlit"] = json::object();
  return result;
}

json material_of(const Material& m, GlbParts& parts) {
  json pbr = {{"baseColorFactor", {m.base_color.x, m.base_color.y, m.base_color.z, m.base_color.w}},
              {"metallicFactor", m.metallic},
              {"roughnessFactor", m.roughness}};
  write_slot(m.base_color_texture, "baseColorTexture", pbr, parts);
  write_slot(m.metallic_roughness_texture, "metallicRoughnessTexture", pbr, parts);
  json result = {{"name", m.name}, {"pbrMetallicRoughness", pbr}};
  write_slot(m.emission_texture, "emissiveTexture", result, parts);
  json extensions = extensions_of(m);
  const float strength = power_of_two_above(m.emission);
  result["emissiveFactor"] =
      numbers(Vec3{m.emission.x / strength, m.emission.y / strength, m.emission.z / strength});
  if (strength != 1) {
    extensions["KHR_materials_emissive_strength"] = {{"emissiveStrength", strength}};
  }
  if (m.double_sided) result["doubleSided"] = true;
  for (const auto& item : extensions.items()) parts.extensions.insert(item.key());
  if (!extensions.empty()) result["extensions"] = extensions;
  return result;
}

}  // namespace

float power_of_two_above(Vec3 value) {
  const float most = std::max({value.x, value.y, value.z});
  if (!(most > 1)) return 1;
  int exponent = 0;
  const float rest = std::frexp(most, &exponent);
  // 2^128 is no float: the largest numbers keep a factor of nearly 2.
  return std::ldexp(1.0f, std::min(rest == 0.5f ? exponent - 1 : exponent, 127));
}

void write_materials(const SceneDescription& scene, GlbParts& parts) {
  for (const Image& image : scene.images) {
    const std::size_t view = parts.add_view(encode_png(image));
    parts.add("images", {{"name", image.name}, {"mimeType", "image/png"}, {"bufferView", view}});
  }
  for (const Texture& texture : scene.textures) {
    const std::size_t sampler = find_or_add(parts, "samplers", sampler_of(texture));
    parts.add("textures", {{"source", texture.image}, {"sampler", sampler}});
  }
  for (const Material& material : scene.materials) {
    parts.add("materials", material_of(material, parts));
  }
}

}  // namespace raysheaf::io
