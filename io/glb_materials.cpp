#include <algorithm>
#include <cmath>

#include "io/glb_writer.h"
#include "io/image.h"
#include "raysheaf/io.h"

namespace raysheaf::io {
namespace {

Json numbers(Vec2 v) {
  return JsonArray{v.x, v.y};
}
Json numbers(Vec3 v) {
  return JsonArray{v.x, v.y, v.z};
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
Json sampler_of(const Texture& texture) {
  const bool nearest = texture.filter == Filter::kNearest;
  return JsonObject{{"magFilter", nearest ? 9728 : 9729},
                    {"minFilter", nearest ? 9728 : 9729},
                    {"wrapS", gl_wrap(texture.wrap_u)},
                    {"wrapT", gl_wrap(texture.wrap_v)}};
}

void write_slot(const TextureSlot& slot, const char* name, JsonObject& object, GlbParts& parts,
                float scale = 1) {
  if (slot.texture == kInvalidId) return;
  JsonObject info{{"index", slot.texture}}, transform;
  if (scale != 1) info.add("scale", scale);
  if (slot.second_uvs) info.add("texCoord", 1);
  if (!equal(slot.offset, {0, 0})) transform.add("offset", numbers(slot.offset));
  if (!equal(slot.scale, {1, 1})) transform.add("scale", numbers(slot.scale));
  if (slot.rotation != 0) transform.add("rotation", slot.rotation);
  if (!transform.empty()) {
    info.add("extensions", JsonObject{{"KHR_texture_transform", transform}});
    parts.extensions.insert("KHR_texture_transform");
  }
  object.add(name, info);
}

/// The extensions for properties that differ from glTF's defaults. `strength` is that of the
/// emission.
JsonObject extensions_of(const Material& m, float strength, GlbParts& parts) {
  JsonObject result;
  const auto add = [&](const char* name, const JsonObject& value) {
    result.add(name, value);
    parts.extensions.insert(name);
  };
  if (m.transmission != 0 || m.thin)
    add("KHR_materials_transmission", {{"transmissionFactor", m.transmission}});
  // Any thickness marks a solid body: a ray tracer finds the real one.
  if (m.transmission != 0 && !m.thin) add("KHR_materials_volume", {{"thicknessFactor", 1}});
  if (m.ior != 1.5f) add("KHR_materials_ior", {{"ior", m.ior}});
  if (m.specular != 1 || !equal(m.specular_color, {1, 1, 1})) {
    add("KHR_materials_specular",
        {{"specularFactor", m.specular}, {"specularColorFactor", numbers(m.specular_color)}});
  }
  if (m.unlit) add("KHR_materials_unlit", {});
  if (strength != 1) add("KHR_materials_emissive_strength", {{"emissiveStrength", strength}});
  return result;
}

Json material_of(const Material& m, GlbParts& parts) {
  const Vec4 base = m.base_color;
  JsonObject pbr{{"baseColorFactor", JsonArray{base.x, base.y, base.z, base.w}},
                 {"metallicFactor", m.metallic},
                 {"roughnessFactor", m.roughness}};
  write_slot(m.base_color_texture, "baseColorTexture", pbr, parts);
  write_slot(m.metallic_roughness_texture, "metallicRoughnessTexture", pbr, parts);
  JsonObject result{{"name", m.name}, {"pbrMetallicRoughness", pbr}};
  write_slot(m.emission_texture, "emissiveTexture", result, parts);
  write_slot(m.normal_texture, "normalTexture", result, parts, m.normal_scale);
  const float strength = power_of_two_above(m.emission);
  const Vec3 e = m.emission;
  result.add("emissiveFactor", numbers(Vec3{e.x / strength, e.y / strength, e.z / strength}));
  if (m.double_sided) result.add("doubleSided", true);
  if (m.alpha_blend) {
    result.add("alphaMode", "BLEND");
  } else if (m.alpha_cutoff > 0) {
    result.add("alphaMode", "MASK");
    result.add("alphaCutoff", m.alpha_cutoff);
  }
  const JsonObject extensions = extensions_of(m, strength, parts);
  if (!extensions.empty()) result.add("extensions", extensions);
  return result;
}

}  // namespace

float power_of_two_above(Vec3 value) {
  const float most = std::max({value.x, value.y, value.z});
  if (!(most > 1)) return 1;
  int exponent = 0;
  const float rest = std::frexp(most, &exponent);
  // 2^128 does not fit a float; the largest values keep a factor of nearly 2.
  return std::ldexp(1.0f, std::min(rest == 0.5f ? exponent - 1 : exponent, 127));
}

void write_materials(const SceneDescription& scene, GlbParts& parts) {
  for (const Image& image : scene.images) {
    const std::size_t view = parts.add_view(encode_png(image));
    parts.add("images",
              JsonObject{{"name", image.name}, {"mimeType", "image/png"}, {"bufferView", view}});
  }
  for (const Texture& texture : scene.textures) {
    const std::size_t sampler = parts.find_or_add("samplers", sampler_of(texture));
    parts.add("textures", JsonObject{{"source", texture.image}, {"sampler", sampler}});
  }
  for (const Material& material : scene.materials) {
    parts.add("materials", material_of(material, parts));
  }
}

}  // namespace raysheaf::io
