#include <algorithm>

#include "io/gltf.h"

namespace raysheaf::io {
namespace {

using tinygltf::Value;

const Value* member(const Value& object, const char* name) {
  return object.IsObject() && object.Has(name) ? &object.Get(name) : nullptr;
}
const Value* extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto it = extensions.find(name);
  return it == extensions.end() ? nullptr : &it->second;
}

float number(const Value& object, const char* name, float fallback) {
  const Value* value = member(object, name);
  return value == nullptr ? fallback : static_cast<float>(value->GetNumberAsDouble());
}
float item(const Value& array, std::size_t i) {
  return static_cast<float>(array.Get(static_cast<int>(i)).GetNumberAsDouble());
}
Vec2 vec2(const Value& object, const char* name, Vec2 fallback) {
  const Value* value = member(object, name);
  return value == nullptr ? fallback : Vec2{item(*value, 0), item(*value, 1)};
}
Vec3 vec3(const Value& object, const char* name, Vec3 fallback) {
  const Value* value = member(object, name);
  return value == nullptr ? fallback : Vec3{item(*value, 0), item(*value, 1), item(*value, 2)};
}

Wrap wrap_of(int gl) {
  if (gl == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::kClampToEdge;
  return gl == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::kMirroredRepeat : Wrap::kRepeat;
}

/// Textures whose image could be read, and where each of glTF's went.
std::vector<std::uint32_t> read_textures(const GltfModel& gltf, SceneDescription& scene,
                                         Warnings& warnings) {
  std::vector<std::string> sentences;
  DecodedImages images = decode_images(gltf.images, sentences);
  for (const std::string& sentence : sentences) warnings.once(sentence);
  scene.images = std::move(images.images);
  std::vector<std::uint32_t> index_of;
  for (const tinygltf::Texture& source : gltf.model.textures) {
    if (source.source < 0)
      warnings.once("Textures without an image that can be read are left out.");
    const std::uint32_t image =
        source.source < 0 ? kInvalidId : images.index_of[static_cast<std::size_t>(source.source)];
    if (image == kInvalidId) {
      index_of.push_back(kInvalidId);
      continue;
    }
    Texture texture{image};
    if (source.sampler >= 0) {
      const auto& sampler = gltf.model.samplers[static_cast<std::size_t>(source.sampler)];
      texture.wrap_u = wrap_of(sampler.wrapS);
      texture.wrap_v = wrap_of(sampler.wrapT);
      const bool nearest = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
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

  Material read(const tinygltf::Material& source) {
    uv_set_ = first_set(source);
    Material material;
    material.name = source.name;
    material.double_sided = source.doubleSided;
    read_base(source, material);
    read_extensions(source.extensions, material);
    if (source.alphaMode != "OPAQUE" && !source.alphaMode.empty()) {
      warnings_.once("The alpha mode " + source.alphaMode.substr(0, 16) +
                     " is left out: every surface is opaque.");
    }
    if (source.normalTexture.index >= 0) warnings_.once("Normal textures are left out.");
    if (source.occlusionTexture.index >= 0) warnings_.once("Occlusion textures are left out.");
    return material;
  }
  [[nodiscard]] int uv_set() const { return uv_set_; }

 private:
  static int set_of(const tinygltf::TextureInfo& info) {
    const Value* transform = extension(info.extensions, "KHR_texture_transform");
    const Value* set = transform == nullptr ? nullptr : member(*transform, "texCoord");
    return set == nullptr ? info.texCoord : set->GetNumberAsInt();
  }
  /// The base colour's set; where it has no texture, the set of the first slot that has one.
  static int first_set(const tinygltf::Material& source) {
    const auto& pbr = source.pbrMetallicRoughness;
    for (const auto* info :
         {&pbr.baseColorTexture, &pbr.metallicRoughnessTexture, &source.emissiveTexture}) {
      if (info->index >= 0) return set_of(*info);
    }
    return 0;
  }

  TextureSlot slot(const tinygltf::TextureInfo& info, const char* what) {
    TextureSlot slot;
    if (info.index < 0) return slot;
    if (set_of(info) != uv_set_) {
      warnings_.once(std::string("The ") + what +
                     " texture uses another set of coordinates than the base colour; it is read "
                     "with the base colour's.");
    }
    slot.texture = textures_[static_cast<std::size_t>(info.index)];
    if (const Value* transform = extension(info.extensions, "KHR_texture_transform")) {
      slot.offset = vec2(*transform, "offset", {0, 0});
      slot.scale = vec2(*transform, "scale", {1, 1});
      slot.rotation = number(*transform, "rotation", 0);
    }
    return slot;
  }

  void read_base(const tinygltf::Material& source, Material& material) {
    const auto& pbr = source.pbrMetallicRoughness;
    const auto part = [](const std::vector<double>& values, std::size_t i) {
      return static_cast<float>(values[i]);
    };
    if (pbr.baseColorFactor.size() == 4) {
      const auto& f = pbr.baseColorFactor;
      material.base_color = {part(f, 0), part(f, 1), part(f, 2), part(f, 3)};
    }
    if (source.emissiveFactor.size() == 3) {
      const auto& f = source.emissiveFactor;
      material.emission = {part(f, 0), part(f, 1), part(f, 2)};
    }
    material.metallic = static_cast<float>(pbr.metallicFactor);
    material.roughness = static_cast<float>(pbr.roughnessFactor);
    material.base_color_texture = slot(pbr.baseColorTexture, "base colour");
    material.metallic_roughness_texture = slot(pbr.metallicRoughnessTexture, "metallic-roughness");
    material.emission_texture = slot(source.emissiveTexture, "emission");
  }

  void read_extensions(const tinygltf::ExtensionMap& extensions, Material& material) {
    if (const Value* x = extension(extensions, "KHR_materials_transmission")) {
      material.transmission = number(*x, "transmissionFactor", 0);
      if (member(*x, "transmissionTexture")) warnings_.once("Transmission textures are left out.");
    }
    if (const Value* x = extension(extensions, "KHR_materials_ior")) {
      material.ior = number(*x, "ior", 1.5f);
    }
    if (const Value* x = extension(extensions, "KHR_materials_specular")) {
      material.specular = number(*x, "specularFactor", 1);
      material.specular_color = vec3(*x, "specularColorFactor", {1, 1, 1});
      if (member(*x, "specularTexture") || member(*x, "specularColorTexture")) {
        warnings_.once("Specular textures are left out.");
      }
    }
    if (const Value* x = extension(extensions, "KHR_materials_emissive_strength")) {
      const float strength = number(*x, "emissiveStrength", 1);
      Vec3& e = material.emission;
      e = {e.x * strength, e.y * strength, e.z * strength};
    }
    material.unlit = extension(extensions, "KHR_materials_unlit") != nullptr;
  }

  std::vector<std::uint32_t> textures_;
  Warnings& warnings_;
  int uv_set_ = 0;
};

}  // namespace

std::vector<int> read_materials(const GltfModel& gltf, SceneDescription& scene,
                                Warnings& warnings) {
  MaterialReader reader(read_textures(gltf, scene, warnings), warnings);
  std::vector<int> uv_sets;
  for (const tinygltf::Material& source : gltf.model.materials) {
    scene.materials.push_back(reader.read(source));
    uv_sets.push_back(reader.uv_set());
  }
  return uv_sets;
}

}  // namespace raysheaf::io
