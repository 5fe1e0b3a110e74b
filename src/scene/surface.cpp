#include "scene/surface.h"

#include <optional>

#include "scene/material_of.h"
#include "scene/surface_body.h"
#include "scene/surface_reader.h"

namespace raysheaf {
namespace {

Vec3 rgb(Vec4 color) {
  return {color.x, color.y, color.z};
}

/// Corners' values with the weights of a place.
template <class T>
T mixed(const T (&of_corner)[3], float u, float v) {
  return of_corner[0] * (1 - u - v) + of_corner[1] * u + of_corner[2] * v;
}

/// Unit, on the front side: counter-clockwise, clockwise where the instance mirrors. Nothing where
/// the triangle has no area.
Vec3 front_normal(const Vec3 (&corner)[3], bool mirrored) {
  const Wide along = cross(difference(corner[1], corner[0]), difference(corner[2], corner[0]));
  const Vec3 normal = unit(along, {0, 0, 0});
  return mirrored ? -normal : normal;
}

/// The textures at a place. They need coordinates: a mesh without them shows the factors alone.
class Look {
 public:
  explicit Look(const TextureSet& textures, std::optional<Vec2> uv = {})
      : textures_(textures), uv_(uv) {}
  [[nodiscard]] Vec3 color(const TextureSlot& slot) const {
    return uv_ ? rgb(textures_.color(slot, *uv_)) : Vec3{1, 1, 1};
  }
  [[nodiscard]] Vec3 numbers(const TextureSlot& slot) const {
    return uv_ ? rgb(textures_.numbers(slot, *uv_)) : Vec3{1, 1, 1};
  }

 private:
  const TextureSet& textures_;
  std::optional<Vec2> uv_;
};

void set_material(Surface& surface, const Material& material, const Look& look) {
  const Vec3 base = rgb(material.base_color) * look.color(material.base_color_texture);
  surface.unlit = material.unlit;
  if (material.unlit) {
    surface.emission = base;
    return;
  }
  const Vec3 rough_metal = look.numbers(material.metallic_roughness_texture);
  const float metallic = material.metallic * rough_metal.z;
  const float normal_reflectance = (material.ior - 1) / (material.ior + 1);
  const Vec3 dielectric =
      min(material.specular_color * (normal_reflectance * normal_reflectance), {1, 1, 1}) *
      material.specular;
  surface.roughness = material.roughness * rough_metal.y;
  surface.transmission = material.transmission * (1 - metallic);
  surface.transmission_color = base;
  surface.ior = material.ior >= 1 ? material.ior : 1;
  surface.diffuse = base * ((1 - metallic) * (1 - material.transmission));
  surface.specular = lerp(dielectric, base, metallic);
  surface.coat = dielectric;
  surface.emission = material.emission * look.color(material.emission_texture);
}

}  // namespace

void SurfaceReader::hold(const FlatScene& flat, std::uint32_t triangle) {
  if (triangle == triangle_) return;
  triangle_ = triangle;
  const FlatMesh& placed = flat.meshes[flat.mesh_of_triangle[triangle]];
  const Mesh& mesh = scene_.meshes[placed.geom_id];
  if (flat.mesh_of_triangle[triangle] != mesh_) {
    mesh_ = flat.mesh_of_triangle[triangle];
    material_ = nullptr;  // its mesh may have other coordinates
    t_.has_normals = !mesh.normals.empty();
    t_.has_uvs = !mesh.uvs.empty();
    t_.mirrored = placed.mirrored;
    t_.to_world = scene_.instances[placed.inst_id].to_world;
    normal_map_ = normal_map(t_.to_world);
  }
  const std::uint32_t prim_id = triangle - placed.first_triangle;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t vertex = mesh.triangles[prim_id][static_cast<std::size_t>(k)];
    t_.corner[k] = flat.corner(triangle, k);
    if (t_.has_normals) t_.normal[k] = mesh.normals[vertex];
    if (t_.has_uvs) t_.uv[k] = mesh.uvs[vertex];
  }
  front_ = front_normal(t_.corner, t_.mirrored);
  hold_material(material_of(mesh, prim_id));
}

void SurfaceReader::hold(const SurfaceTriangle& triangle) {
  triangle_ = mesh_ = kInvalidId;
  t_ = triangle;
  material_ = nullptr;
  normal_map_ = normal_map(t_.to_world);
  front_ = front_normal(t_.corner, t_.mirrored);
  hold_material(triangle.material);
}

void SurfaceReader::hold_material(std::uint32_t material) {
  if (material_ != nullptr && material == t_.material) return;
  t_.material = material;
  material_ = &material_or_default(scene_, material);
  const auto is_there = [](const TextureSlot& slot) { return slot.texture != kInvalidId; };
  textured_ = t_.has_uvs && (is_there(material_->base_color_texture) ||
                             is_there(material_->metallic_roughness_texture) ||
                             is_there(material_->emission_texture));
  look_ = {};
  look_.material = material;
  if (!textured_) set_material(look_, *material_, Look(textures_));
}

Surface SurfaceReader::at(float u, float v, Vec3 direction) const {
  Surface surface = look_;
  const MixedPoint point = mixed_point(t_.corner[0], t_.corner[1], t_.corner[2], u, v);
  surface.position = point.position;
  surface.position_error = point.error;
  const bool flat = front_ == Vec3{0, 0, 0};
  const Vec3 front = flat ? unit(widened(-direction), {0, 0, 1}) : front_;
  surface.front = !(dot(widened(front), widened(direction)) > 0);
  const Vec3 shading =
      t_.has_normals ? unit_normal(normal_map_, mixed(t_.normal, u, v), front) : front;
  surface.geometric_normal = surface.front ? front : -front;
  surface.normal = surface.front ? shading : -shading;
  if (textured_) set_material(surface, *material_, Look(textures_, mixed(t_.uv, u, v)));
  return surface;
}

Surface surface_of(const SceneDescription& scene, const TextureSet& textures,
                   const SurfaceTriangle& triangle, float u, float v, Vec3 direction) {
  SurfaceReader reader(scene, textures);
  reader.hold(triangle);
  return reader.at(u, v, direction);
}

Surface surface_at(const FlatScene& scene, const TextureSet& textures, std::uint32_t triangle,
                   float u, float v, Vec3 direction) {
  SurfaceReader reader(*scene.description, textures);
  reader.hold(scene, triangle);
  return reader.at(u, v, direction);
}

}  // namespace raysheaf
