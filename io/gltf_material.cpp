#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "io/gltf.h"
#include "io/gltf_json.h"
#include "io/refuse.h"

namespace raysheaf::io {
namespace {

/// The array's numbers, as many as `fallback` has.
template <std::size_t kCount>
std::array<float, kCount> floats(const JsonValue& object, const char* name,
                                 std::array<float, kCount> fallback) {
  const auto items = object.items(name);
  for (std::size_t i = 0; i < items.size(); ++i) fallback[i] = items[i].get<float>();
  return fallback;
}
Vec2 vec2(const JsonValue& object, const char* name, float fallback) {
  const auto [x, y] = floats<2>(object, name, {fallback, fallback});
  return {x, y};
}
Vec3 vec3(const JsonValue& object, const char* name, float fallback) {
  const auto [x, y, z] = floats<3>(object, name, {fallback, fallback, fallback});
  return {x, y, z};
}
Vec4 vec4(const JsonValue& object, const char* name, float fallback) {
  const auto [x, y, z, w] = floats<4>(object, name, {fallback, fallback, fallback, fallback});
  return {x, y, z, w};
}

/// OpenGL's codes, which glTF uses.
constexpr int kNearest = 9728, kRepeat = 10497, kClampToEdge = 33071, kMirroredRepeat = 33648;

Wrap wrap_of(int gl) {
  if (gl == kClampToEdge) return Wrap::kClampToEdge;
  return gl == kMirroredRepeat ? Wrap::kMirroredRepeat : Wrap::kRepeat;
}

/// Reads the textures whose images could be decoded. Returns the scene's index of each glTF
/// texture.
std::vector<std::uint32_t> read_textures(const GltfModel& model, SceneDescription& scene,
                                         Warnings& warnings) {
  std::vector<std::string> sentences;
  DecodedImages images = decode_images(model.images, sentences);
  for (const std::string& sentence : sentences) warnings.once(sentence);
  scene.images = std::move(images.images);
  std::vector<std::uint32_t> index_of;
  for (const JsonValue& source : model.list("textures")) {
    const JsonValue* webp = extension(source, "EXT_texture_webp");
    std::uint32_t image = kInvalidId;
    for (const JsonValue* from : {webp, &source}) {
      const JsonValue* number = from == nullptr ? nullptr : from->find("source");
      if (image == kInvalidId && number != nullptr)
        image = images.index_of[number->get<std::size_t>()];
    }
    if (!source.contains("source") && (webp == nullptr || !webp->contains("source")))
      warnings.once("Textures without an image that can be read are left out.");
    if (image == kInvalidId) {
      index_of.push_back(kInvalidId);
      continue;
    }
    Texture texture{image};
    if (const JsonValue* used = source.find("sampler")) {
      const JsonValue& sampler = model.list("samplers")[used->get<std::size_t>()];
      texture.wrap_u = wrap_of(sampler.get("wrapS", kRepeat));
      texture.wrap_v = wrap_of(sampler.get("wrapT", kRepeat));
      const bool nearest = sampler.get("magFilter", -1) == kNearest;
      texture.filter = nearest ? Filter::kNearest : Filter::kLinear;
    }
    index_of.push_back(static_cast<std::uint32_t>(scene.textures.size()));
    scene.textures.push_back(texture);
  }
  return index_of;
}

class MaterialReader {
 public:
  MaterialReader(std::vector<std::uint32_t> textures, Warnings& warnings)
      : textures_(std::move(textures)), warnings_(warnings) {}

  Material read(const JsonValue& source, const std::string& place) {
    const JsonValue* pbr = source.find("pbrMetallicRoughness");
    const JsonValue* gloss = extension(source, "KHR_materials_pbrSpecularGlossiness");
    const JsonValue nothing;
    if (pbr == nullptr && gloss != nullptr) {
      read_base(source, gloss->find("diffuseTexture"), nullptr);
      read_gloss(*gloss);
    } else {
      read_metallic(source, pbr == nullptr ? nothing : *pbr);
    }
    read_extensions(source, place + ".extensions.");
    read_alpha(source);
    if (source.contains("occlusionTexture")) warnings_.once("Occlusion textures are left out.");
    return std::move(material_);
  }
  [[nodiscard]] UvSets uv_sets() const { return uv_sets_; }

 private:
  static int set_of(const JsonValue& info) {
    const int set = info.get("texCoord", 0);
    const JsonValue* transform = extension(info, "KHR_texture_transform");
    return transform == nullptr ? set : transform->get("texCoord", set);
  }

  TextureSlot slot(const JsonValue* info, const char* what) {
    TextureSlot slot;
    if (info == nullptr) return slot;
    const int set = set_of(*info);
    slot.second_uvs = set == uv_sets_.second;
    if (set != uv_sets_.first && !slot.second_uvs) {
      warnings_.once(std::string("The ") + what +
                     " texture uses a third set of coordinates in its material; it is read with "
                     "the first.");
    }
    slot.texture = textures_[info->at("index").get<std::size_t>()];
    if (const JsonValue* transform = extension(*info, "KHR_texture_transform")) {
      slot.offset = vec2(*transform, "offset", 0);
      slot.scale = vec2(*transform, "scale", 1);
      slot.rotation = transform->get("rotation", 0.0f);
    }
    return slot;
  }

  /// Reads the properties that both material models share.
  void read_base(const JsonValue& source, const JsonValue* base,
                 const JsonValue* metallic_roughness) {
    const JsonValue* emission = source.find("emissiveTexture");
    const JsonValue* normal = source.find("normalTexture");
    // The first set is the one of the base colour's texture, or of the first slot with a texture.
    // The next different one becomes the second set.
    uv_sets_ = {};
    bool has_first = false;
    for (const JsonValue* info : {base, metallic_roughness, emission, normal}) {
      if (info == nullptr) continue;
      const int set = set_of(*info);
      if (!std::exchange(has_first, true))
        uv_sets_.first = set;
      else if (set != uv_sets_.first && uv_sets_.second < 0)
        uv_sets_.second = set;
    }
    material_ = {};
    material_.name = source.get("name", std::string());
    material_.double_sided = source.get("doubleSided", false);
    material_.emission = vec3(source, "emissiveFactor", 0);
    material_.base_color_texture = slot(base, "base colour");
    material_.metallic_roughness_texture = slot(metallic_roughness, "metallic-roughness");
    material_.emission_texture = slot(emission, "emission");
    material_.normal_texture = slot(normal, "normal");
    if (normal != nullptr) material_.normal_scale = normal->get("scale", 1.0f);
  }

  void read_metallic(const JsonValue& source, const JsonValue& pbr) {
    read_base(source, pbr.find("baseColorTexture"), pbr.find("metallicRoughnessTexture"));
    material_.base_color = vec4(pbr, "baseColorFactor", 1);
    material_.metallic = pbr.get("metallicFactor", 1.0f);
    material_.roughness = pbr.get("roughnessFactor", 1.0f);
  }

  /// Reads the older model, specular-glossiness, if the material has no other: a surface reflects
  /// `specularFactor` at normal incidence, and the rest is reflected with the diffuse colour.
  void read_gloss(const JsonValue& gloss) {
    material_.base_color = vec4(gloss, "diffuseFactor", 1);
    material_.metallic = 0;
    if (gloss.contains("specularGlossinessTexture")) {
      warnings_.once("Specular-glossiness textures are left out: such surfaces get roughness 1.");
      material_.roughness = 1;
      return;
    }
    material_.roughness = 1 - gloss.get("glossinessFactor", 1.0f);
    material_.ior = 0;  // overrides KHR_materials_ior: only the specular colour counts
    material_.specular_color = vec3(gloss, "specularFactor", 1);
    const Vec3 s = material_.specular_color;
    const float rest = std::max(0.0f, 1 - std::max({s.x, s.y, s.z}));
    Vec4& base = material_.base_color;
    base = {base.x * rest, base.y * rest, base.z * rest, base.w};
  }

  void read_alpha(const JsonValue& source) {
    const auto mode = source.get("alphaMode", std::string("OPAQUE"));
    if (mode == "OPAQUE" || mode.empty()) return;
    if (mode == "MASK") {
      material_.alpha_cutoff = source.get("alphaCutoff", 0.5f);
    } else if (mode == "BLEND") {
      material_.alpha_blend = true;
      const bool varies = material_.base_color_texture.texture != kInvalidId;
      material_.alpha_cutoff = varies ? 0.5f : 0;
      if (varies || material_.base_color.w < 1)
        warnings_.once(
            "The alpha mode BLEND is blended by random samples; with one sample per pixel, "
            "surfaces are cut out where their texture's alpha is below 0.5; without a texture they "
            "are "
            "opaque, or invisible if alpha is 0.");
    } else {
      warnings_.once("The alpha mode " + mode.substr(0, 16) +
                     " is left out: such a surface is opaque.");
    }
  }

  /// Whether a transmitting material is solid, which a thickness indicates.
  bool has_volume(const JsonValue& source) {
    const JsonValue* x = extension(source, "KHR_materials_volume");
    if (x == nullptr || x->get("thicknessFactor", 0.0f) == 0) return false;
    if (x->contains("thicknessTexture")) warnings_.once("Thickness textures are left out.");
    const Vec3 left = vec3(*x, "attenuationColor", 1);
    if (x->contains("attenuationDistance") && std::min({left.x, left.y, left.z}) < 1)
      warnings_.once("The attenuation of light inside glass is left out.");
    return true;
  }

  void read_extensions(const JsonValue& source, const std::string& place) {
    if (const JsonValue* x = extension(source, "KHR_materials_transmission")) {
      material_.transmission = x->get("transmissionFactor", 0.0f);
      if (x->contains("transmissionTexture")) warnings_.once("Transmission textures are left out.");
      material_.thin = !has_volume(source);
    }
    if (const JsonValue* x = extension(source, "KHR_materials_ior")) {
      material_.ior = x->get("ior", 1.5f);
      if (material_.ior < 1 && material_.ior != 0)
        refuse("is " + std::to_string(material_.ior) +
                   ", but must be at least 1, or 0 for a surface that reflects all",
               place + "KHR_materials_ior.ior");
    }
    if (const JsonValue* x = extension(source, "KHR_materials_specular")) {
      material_.specular = x->get("specularFactor", 1.0f);
      material_.specular_color = vec3(*x, "specularColorFactor", 1);
      if (x->contains("specularTexture") || x->contains("specularColorTexture"))
        warnings_.once("Specular textures are left out.");
    }
    if (const JsonValue* x = extension(source, "KHR_materials_emissive_strength")) {
      const float strength = x->get("emissiveStrength", 1.0f);
      Vec3& e = material_.emission;
      e = {e.x * strength, e.y * strength, e.z * strength};
      if (!std::isfinite(e.x + e.y + e.z))
        refuse("makes of emissiveFactor more than a float can hold",
               place + "KHR_materials_emissive_strength.emissiveStrength");
    }
    material_.unlit = extension(source, "KHR_materials_unlit") != nullptr;
  }

  std::vector<std::uint32_t> textures_;
  Warnings& warnings_;
  Material material_;
  UvSets uv_sets_;
};

}  // namespace

std::vector<UvSets> read_materials(const GltfModel& model, SceneDescription& scene,
                                   Warnings& warnings) {
  MaterialReader reader(read_textures(model, scene, warnings), warnings);
  std::vector<UvSets> uv_sets;
  for (const JsonValue& source : model.list("materials")) {
    scene.materials.push_back(reader.read(source, element("materials", uv_sets.size())));
    uv_sets.push_back(reader.uv_sets());
  }
  return uv_sets;
}

}  // namespace raysheaf::io
