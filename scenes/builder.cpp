#include "scenes/builder.h"

#include <algorithm>
#include <utility>

namespace raysheaf::builtin {
namespace {

float linear_from_srgb(std::uint32_t byte) {
  const float c = static_cast<float>(byte & 0xff) / 255;
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

bool reads_texture(const Material& material) {
  return material.base_color_texture.texture != kInvalidId ||
         material.metallic_roughness_texture.texture != kInvalidId ||
         material.emission_texture.texture != kInvalidId ||
         material.normal_texture.texture != kInvalidId;
}

}  // namespace

Affine placed(Vec3 position, float degrees) {
  return compose(translation(position), rotation({0, 1, 0}, radians(degrees)));
}

Vec4 srgb(std::uint32_t rgb) {
  return {linear_from_srgb(rgb >> 16), linear_from_srgb(rgb >> 8), linear_from_srgb(rgb), 1};
}

std::uint32_t Random::next() {
  const std::uint64_t old = state_;
  state_ = old * 6364136223846793005u + 1442695040888963407u;
  const auto shifted = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
  const auto turn = static_cast<std::uint32_t>(old >> 59);
  return (shifted >> turn) | (shifted << ((32 - turn) & 31));
}

float Random::uniform(float low, float high) {
  return low + (high - low) * (static_cast<float>(next() >> 8) * 0x1p-24f);
}

MeshBuilder& MeshBuilder::use(std::uint32_t material) {
  material_ = material;
  return *this;
}

MeshBuilder& MeshBuilder::at(const Affine& frame) {
  frame_ = frame;
  mirrored_ = mirrors(frame);
  return *this;
}

std::uint32_t MeshBuilder::add_vertex(Vec3 position, Vec3 normal, Vec2 uv) {
  mesh_.positions.push_back(transform_point(frame_, position));
  mesh_.normals.push_back(normalized(transform_normal(frame_, normal)));
  mesh_.uvs.push_back(uv);
  return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
}

void MeshBuilder::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (mirrored_) std::swap(b, c);
  mesh_.triangles.push_back({a, b, c});
  mesh_.materials.push_back(material_);
}

void MeshBuilder::add_quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  add_triangle(a, b, c);
  add_triangle(a, c, d);
}

Mesh MeshBuilder::take() {
  auto& materials = mesh_.materials;
  const bool uniform = std::adjacent_find(materials.begin(), materials.end(),
                                          std::not_equal_to<>{}) == materials.end();
  if (uniform && materials.size() > 1) materials.erase(materials.begin() + 1, materials.end());
  return std::exchange(mesh_, Mesh{});
}

std::uint32_t Stage::add(const Material& material) {
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

std::uint32_t Stage::add(Mesh mesh) {
  const bool textured =
      std::any_of(mesh.materials.begin(), mesh.materials.end(),
                  [this](std::uint32_t m) { return reads_texture(scene.materials[m]); });
  if (!textured) mesh.uvs.clear();
  scene.meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(scene.meshes.size() - 1);
}

TextureSlot Stage::add(Image image) {
  scene.images.push_back(std::move(image));
  Texture texture;
  texture.image = static_cast<std::uint32_t>(scene.images.size() - 1);
  scene.textures.push_back(texture);
  TextureSlot slot;
  slot.texture = static_cast<std::uint32_t>(scene.textures.size() - 1);
  return slot;
}

void Stage::place(std::uint32_t mesh, const Affine& to_world, std::string_view name) {
  Instance instance;
  instance.name = name;
  instance.mesh = mesh;
  instance.to_world = to_world;
  scene.instances.push_back(std::move(instance));
}

void Stage::place(const Kit& kit, const Affine& to_world) {
  for (const Part& part : kit.parts) {
    place(part.mesh, compose(to_world, part.to_kit), kit.name + "/" + scene.meshes[part.mesh].name);
  }
}

Material matte(std::string_view name, std::uint32_t rgb, float roughness) {
  Material material;
  material.name = name;
  material.base_color = srgb(rgb);
  material.roughness = roughness;
  return material;
}

}  // namespace raysheaf::builtin
